"""Division of a sequence into batches of limited size, such as the shards of a dataset."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

Item = TypeVar("Item")


def batches(items: Iterable[Item], size: Callable[[Item], int], max_size: int) -> Iterator[tuple[Item, ...]]:
    """Yield the items in their order, in batches with a total size of at most `max_size`.

    A larger item is a batch of its own.
    """
    batch: list[Item] = []
    used = 0
    for item in items:
        item_size = size(item)
        if batch and used + item_size > max_size:
            yield tuple(batch)
            batch, used = [], 0
        batch.append(item)
        used += item_size
    if batch:
        yield tuple(batch)
