"""Limits that a process sets for itself before it reads what a stranger wrote."""

import sys
import time
from pathlib import Path


def limit_time(seconds: int) -> None:
    """Have the system end this process after so much more time of the processor."""
    if sys.platform == "win32":
        return
    import resource  # noqa: PLC0415 - Windows has none

    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    ends = int(time.process_time()) + 1 + seconds
    resource.setrlimit(resource.RLIMIT_CPU, (ends if hard == resource.RLIM_INFINITY else min(ends, hard), hard))


def limit_memory(memory_bytes: int) -> None:
    """Let the system refuse memory beyond so much more than there is; only Linux says how much there is, and obeys."""
    if sys.platform != "linux":
        return
    import resource  # noqa: PLC0415 - as above

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit_bytes = pages * resource.getpagesize() + memory_bytes
    if soft == resource.RLIM_INFINITY or limit_bytes < soft:
        resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, hard))
