"""The calls of an effect's function during an experiment, kept so that they can be repeated."""

import functools
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from configs.effects.base import Effect
from symolo.core.arrays import Array

MAX_CALLS = 400
"""Calls that are kept; a drive makes a few thousand."""


@dataclass(frozen=True)
class Call:
    """One call of `apply`."""

    arguments: tuple[Any, ...]
    """Copies of the arguments from before the call."""
    result: Any


@contextmanager
def recorded(effect: type[Effect]) -> Iterator[list[Call]]:
    """Record the first calls of an effect's function while the block runs."""
    original, calls = effect.apply, []

    @functools.wraps(original)
    def apply(self: Effect, *arguments: Any) -> Any:  # noqa: ANN401 - each slot has its own arguments
        if len(calls) >= MAX_CALLS:
            return original(self, *arguments)
        before = frozen(arguments)
        result = original(self, *arguments)
        calls.append(Call(before, frozen(result)))
        return result

    effect_class: Any = effect  # `apply` differs from slot to slot
    effect_class.apply = apply
    try:
        yield calls
    finally:
        effect_class.apply = original


def frozen(value: Any) -> Any:  # noqa: ANN401 - whatever a slot passes
    """Return a copy that shares no array with the value."""
    return mapped(value, np.copy)


def mapped(value: Any, change: Callable[[Array], Any]) -> Any:  # noqa: ANN401 - as above
    """Return the value with each of its arrays changed, also inside dataclasses, mappings and tuples."""
    if isinstance(value, np.ndarray):
        return change(value)
    if isinstance(value, tuple):
        return tuple(mapped(item, change) for item in value)
    if isinstance(value, Mapping):
        return {key: mapped(item, change) for key, item in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: mapped(getattr(value, f.name), change) for f in fields(value) if f.init})
    return value


def numbers_in(value: Any) -> list[Array]:  # noqa: ANN401 - as above
    """Return the numbers in a value in their order, each as an array."""
    if isinstance(value, (np.ndarray, np.generic, float, int)):
        return [np.asarray(value)]
    if isinstance(value, Mapping):
        return [number for item in value.values() for number in numbers_in(item)]
    if isinstance(value, tuple):
        return [number for item in value for number in numbers_in(item)]
    if is_dataclass(value) and not isinstance(value, type):
        return [number for f in fields(value) for number in numbers_in(getattr(value, f.name))]
    return []


def rows_of(arguments: tuple[Any, ...], row: int) -> tuple[Any, ...]:
    """Return the arguments of one row of a call, whose first argument is an array with the rows as its first axis."""
    rank, length = arguments[0].ndim, len(arguments[0])
    return tuple(mapped(arguments, lambda x: x[row : row + 1] if x.ndim == rank and len(x) == length else x))
