"""Several requests at a time, since the transfer of a small file is mostly waiting."""

from collections.abc import Callable, Generator, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import TypeVar

import numpy as np

AT_ONCE = 16
"""Number of requests in flight; each holds its file, or parts of it, in memory."""
THREAD_BYTES = 10_000_000
"""Address space of a thread: the 8 MiB of its stack, and what it needs to start."""

Item = TypeVar("Item")
Result = TypeVar("Result")


def side_by_side(work: Callable[[Item], Result], items: Iterable[Item]) -> Generator[tuple[Item, Result]]:
    """Yield each item with its result, as soon as it is done; items start in their order.

    Raises:
        MemoryError: There is too little memory for the threads.
        Exception: The first exception of `work`. Running items end first, and no other item starts.
    """
    # Python 3.11 waits without end for a thread that runs out of memory while it starts.
    np.empty(AT_ONCE * THREAD_BYTES, np.uint8)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        begun = {pool.submit(work, item): item for item in items}
        try:
            for future in as_completed(begun):
                yield begun[future], future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
