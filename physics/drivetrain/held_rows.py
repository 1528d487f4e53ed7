"""Voltages at the motors while commands are held row by row, with what delay, lag and battery make of them.

A row is cut where a delayed command comes to act, so that what follows changes smoothly with the delay.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physics.drivetrain.driveline import Driveline
from symolo.core.arrays import Array

LAST_S = 5e-4
"""End of a row over which its last voltage is a mean."""


@dataclass(frozen=True)
class HeldPart:
    """A stretch of time at one voltage; all broadcast, wheels along the last axis."""

    voltage_V: Array
    begin_s: Array
    """Since the motors were first switched on."""
    duration_s: float | Array


@dataclass(frozen=True)
class HeldRow:
    parts: tuple[HeldPart, ...]
    """One, or two where a delayed command comes to act within the row."""
    last_V: Array
    """At the row's end."""


@dataclass(frozen=True)
class _Lasts:
    """A row, and its parts before and after a delayed command comes to act in it."""

    whole_s: float
    before_s: float | Array
    after_s: float | Array


def held_rows(
    driveline: Driveline, command_V: Array, row_s: float, delay_s: float | Array, begin_s: Array
) -> Iterator[HeldRow]:
    """The rows of commands, 0 V before the first.

    Args:
        driveline: Of one robot, or of M.
        command_V: (T, N, wheels), each held for its row.
        row_s: Length of a row.
        delay_s: How much later a command acts, or (M, 1, 1) or (M, N, 1).
        begin_s: (N, 1), time of each trial's start since the motors were first switched on.
    """
    rows = np.arange(len(command_V))
    whole = np.floor(np.divide(delay_s, row_s)).astype(np.int64)
    rest_s = delay_s - whole * row_s
    lasts = _Lasts(row_s, rest_s, row_s - rest_s)
    # An axis of robots before that of trials, of length 1 where they have the delay in common.
    late = whole[:, 0, 0] if whole.ndim else whole.reshape(1)
    padded = np.concatenate([np.zeros_like(command_V[:1]), command_V])
    new_V, old_V = (padded[np.maximum(rows[:, None] + due - late, 0)] for due in (1, 0))
    begin = begin_s + row_s * rows[:, None, None, None]
    is_cut = np.any(rest_s > 0.0) & np.any(old_V != new_V, axis=(1, 2, 3))
    before_V = _held_before(driveline, new_V, old_V, lasts, is_cut)
    last_V, mean_V = (driveline.of_battery_V(volts, begin) for volts in driveline.lagged_V(before_V, new_V, row_s))
    of_row = [list(_without_robots(values)) for values in (mean_V, begin, last_V, before_V, old_V, new_V)]
    for cut, mean, since, last, before, old, new in zip(is_cut.tolist(), *of_row, strict=True):
        if cut:
            yield _cut_row(driveline, before, (old, new), since, lasts)
        else:
            yield HeldRow((HeldPart(mean, since, row_s),), last)


def _held_before(driveline: Driveline, new_V: Array, old_V: Array, lasts: _Lasts, is_cut: NDArray[np.bool_]) -> Array:
    """What a lag holds before each row, (T, M, N, wheels) or broadcast to it; nobody asks where nothing lags."""
    if not driveline.lags:
        return new_V
    held_V, found = np.zeros_like(new_V[0]), []
    for new, old, cut in zip(new_V, old_V, is_cut.tolist(), strict=True):
        found.append(held_V)
        held_V = driveline.held_V(held_V, old, lasts.before_s) if cut else held_V
        held_V = driveline.held_V(held_V, new, lasts.after_s if cut else lasts.whole_s)
    return np.stack(np.broadcast_arrays(*found))


def _cut_row(
    driveline: Driveline, held_V: Array, command_V: tuple[Array, Array], begin_s: Array, lasts: _Lasts
) -> HeldRow:
    """A row in which the command of the one before is followed by its own."""
    old_V, new_V = command_V
    old_last_V, old_mean_V = driveline.lagged_V(held_V, old_V, lasts.before_s)
    held_V, mean_V = driveline.lagged_V(old_last_V, new_V, lasts.after_s)
    last_V = held_V + np.clip(1.0 - lasts.after_s / LAST_S, 0.0, 1.0) * (old_last_V - held_V)
    parts = ((old_mean_V, begin_s, lasts.before_s), (mean_V, begin_s + lasts.before_s, lasts.after_s))
    return HeldRow(
        tuple(HeldPart(driveline.of_battery_V(volts, time), time, duration) for volts, time, duration in parts),
        driveline.of_battery_V(last_V, begin_s),
    )


def _without_robots(values: Array) -> Array:
    """(T, N, wheels) where the axis of robots of (T, M, N, wheels) is of length 1."""
    return values[:, 0] if values.shape[1] == 1 else values
