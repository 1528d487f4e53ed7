"""Voltages at the motors while commands are held row by row, with what delay, lag and battery make of them.

A row is cut where a delayed command comes to act, so that what follows changes smoothly with the delay.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physics.driveline import Driveline

Array = NDArray[np.float64]

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


def held_rows(
    driveline: Driveline, command_V: Array, row_s: float, delay_s: float | Array, begin_s: Array
) -> Iterator[HeldRow]:
    """The rows of commands, 0 V before the first.

    Args:
        driveline: Of one robot, or of M.
        command_V: (T, N, wheels), each held for its row.
        row_s: Length of a row.
        delay_s: How much later a command acts, or (M, 1, 1).
        begin_s: (N, 1), time of each trial's start since the motors were first switched on.
    """
    padded = np.concatenate([np.zeros_like(command_V[:1]), command_V])
    whole = np.floor(np.divide(delay_s, row_s)).astype(np.int64)
    rest_s = delay_s - whole * row_s
    is_cut = bool(np.any(rest_s > 0.0))
    of_robot = whole.reshape(-1) if whole.ndim else whole
    held_V = padded[0]
    for k in range(len(command_V)):
        begin = begin_s + k * row_s
        new_V = padded[np.maximum(k + 1 - of_robot, 0)]
        old_V = padded[np.maximum(k - of_robot, 0)]
        if not is_cut or np.array_equal(old_V, new_V):
            held_V, mean_V = driveline.lagged_V(held_V, new_V, row_s)
            last_V = held_V
            parts = ((mean_V, begin, row_s),)
        else:
            old_last_V, old_mean_V = driveline.lagged_V(held_V, old_V, rest_s)
            held_V, mean_V = driveline.lagged_V(old_last_V, new_V, row_s - rest_s)
            parts = ((old_mean_V, begin, rest_s), (mean_V, begin + rest_s, row_s - rest_s))
            last_V = held_V + np.clip(1.0 - (row_s - rest_s) / LAST_S, 0.0, 1.0) * (old_last_V - held_V)
        yield HeldRow(
            tuple(HeldPart(driveline.of_battery_V(volts, time), time, duration) for volts, time, duration in parts),
            driveline.of_battery_V(last_V, begin),
        )
