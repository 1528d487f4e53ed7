"""A limit on the address space, with which libraries would hang or fail one by one."""

import os
import resource

from symolo.core.errors import EnvironmentLacking

_MB = 1_000_000
BASE_MB = 1000
MB_PER_CORE = 100
"""OpenBLAS, of which NumPy and SciPy have one each, takes 32 MB and a stack of 8 MB for each core."""


def check_address_space() -> None:
    """Check that a process may address enough memory to load all libraries, and take what OpenBLAS needs.

    OpenBLAS asks again without end for memory that it does not get, and heeds no signal: while it is loaded, and at the
    first product or inverse, which may be long after.

    Raises:
        EnvironmentLacking: It may not.
    """
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    needed_mb = BASE_MB + MB_PER_CORE * (os.cpu_count() or 1)
    if limit == resource.RLIM_INFINITY:
        return
    if limit < needed_mb * _MB:
        raise EnvironmentLacking(
            f"there is not enough memory: this process may address {limit // _MB} MB, and its libraries need up to"
            f" {needed_mb} MB; raise the limit, such as by `ulimit -v unlimited`, and run the same command again"
        )
    take_buffers()


def take_buffers() -> None:
    """Let both OpenBLAS take the memory of their first call, which they keep for all later ones."""
    import numpy as np  # noqa: PLC0415 - nothing else of a process without a limit needs it this early
    import scipy.linalg  # noqa: PLC0415

    for inverse in (np.linalg.inv, scipy.linalg.inv):
        inverse(np.eye(2))
