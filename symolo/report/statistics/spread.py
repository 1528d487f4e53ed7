"""A choice of a few items out of many, evenly spread over their order."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

T = TypeVar("T")


def spread(items: Sequence[T], max_items: int) -> list[T]:
    """Return up to `max_items` items in their order: the first, the last and some between, or only the middle one."""
    if len(items) <= max_items:
        return list(items)
    if max_items == 1:
        return [items[len(items) // 2]]
    return [items[i] for i in np.linspace(0, len(items) - 1, max_items).round().astype(int).tolist()]
