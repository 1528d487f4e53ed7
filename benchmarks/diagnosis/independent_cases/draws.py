"""Draws of single numbers. Every function takes a generator, so that a seed fixes a case."""

import math
from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np

Item = TypeVar("Item")


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number between low and high that is uniform in its logarithm; the unit is that of low."""
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def draw_sign(rng: np.random.Generator) -> float:
    """Draw +1 or -1 with equal chance."""
    return 1.0 if rng.random() < 0.5 else -1.0


def pick(rng: np.random.Generator, items: Sequence[Item]) -> Item:
    """Draw one of the items; it keeps its Python type."""
    return items[int(rng.integers(len(items)))]


def significant(value: float, digits: int = 4) -> float:
    """Round the value to that many significant digits."""
    if value == 0 or not math.isfinite(value):
        return float(value)
    return float(round(value, digits - 1 - math.floor(math.log10(abs(value)))))


def deal(rng: np.random.Generator, items: Iterable[str], count: int) -> list[str]:
    """Deal `count` items from shuffled packs of all items, so that each comes about equally often."""
    dealt: list[str] = []
    while len(dealt) < count:
        pack = list(items)
        rng.shuffle(pack)
        dealt += pack
    return dealt[:count]
