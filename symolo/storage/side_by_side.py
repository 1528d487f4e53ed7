"""Several requests at a time: with many small files, each of them is little else than waiting."""

from collections.abc import Callable, Generator, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import TypeVar

AT_ONCE = 16
"""Requests in flight, each with its file, or the parts of it, in memory."""

Item = TypeVar("Item")
Result = TypeVar("Result")


def side_by_side(work: Callable[[Item], Result], items: Iterable[Item]) -> Generator[tuple[Item, Result]]:
    """Each item with what came of it, in the order in which they end; begun in the order given.

    Raises:
        Exception: The first that `work` raised; what is in flight then is ended first, and nothing new is begun.
    """
    with ThreadPoolExecutor(AT_ONCE) as pool:
        begun = {pool.submit(work, item): item for item in items}
        try:
            for future in as_completed(begun):
                yield begun[future], future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
