"""Voltages at the motors for commands that are held in each row (zero-order hold), after delay, lag and battery.

A row is divided where a delayed command takes effect, so that results change smoothly with the delay.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from physics.drivetrain.driveline import Driveline
from physics.drivetrain.motion import voltage_trend
from symolo.core.arrays import Array, stacked_rows

LAST_S = 5e-4
"""Length of the end of a row over which `HeldRow.last_V` is a mean."""


@dataclass(frozen=True)
class HeldPart:
    """A period at constant voltage; all broadcast, wheels along the last axis."""

    voltage_V: Array
    supply_V: float | Array
    """Voltage of the supply without load, of which the mean voltage is a share."""
    begin_s: Array
    """Beginning of the period, since the motors were first switched on."""
    duration_s: float | Array
    trend: float | Array
    """Whether the size of the commanded voltage last grew (+1) or fell (-1)."""
    heat: float | Array
    """Share by which heat has raised the resistance of the windings, at the beginning."""


@dataclass(frozen=True)
class HeldRow:
    parts: tuple[HeldPart, ...]
    """Parts of the row: one, or two if a delayed command takes effect within the row."""
    last_V: Array
    """Voltage at the end of the row."""
    supply_V: float | Array
    """Voltage of the supply without load, at the beginning of the row."""
    last_heat: float | Array
    """Share by which heat has raised the resistance at the end of the row."""


@dataclass(frozen=True)
class _Durations:
    """Durations of a row and of its parts before and after a delayed command takes effect."""

    whole_s: float
    before_s: float | Array
    after_s: float | Array


def joined_parts(parts: Iterable[HeldPart]) -> Iterator[HeldPart]:
    """Yield successive periods, those with equal voltages as one."""
    whole: HeldPart | None = None
    for part in parts:
        if whole is None:
            whole = part
        elif _is_like(part, whole):
            whole = replace(whole, duration_s=whole.duration_s + part.duration_s)
        else:
            yield whole
            whole = part
    if whole is not None:
        yield whole


def _is_like(part: HeldPart, before: HeldPart) -> bool:
    """Return whether a period goes on as the one before it."""
    pairs = ((p, b) for p, b in zip(_conditions(part), _conditions(before), strict=True))
    return all(np.array_equal(p, b) for p, b in pairs)


def _conditions(part: HeldPart) -> tuple[float | Array, ...]:
    return part.voltage_V, part.supply_V, part.trend, part.heat


def held_rows(
    driveline: Driveline, command_V: Array, row_s: float, delay_s: float | Array, begin_s: Array
) -> Iterator[HeldRow]:
    """Yield the voltages of each row; commands are 0 V before the first.

    Args:
        driveline: Motors of one robot, or of M.
        command_V: (T, N, wheels), each constant for its row.
        row_s: Duration of a row.
        delay_s: Delay of commands; a number, (M, 1, 1) or (M, N, 1).
        begin_s: (N, 1), time of each trial's start since the motors were first switched on.
    """
    rows = np.arange(len(command_V))
    whole = np.floor(np.divide(delay_s, row_s)).astype(np.int64)
    rest_s = delay_s - whole * row_s
    durations = _Durations(row_s, rest_s, row_s - rest_s)
    # An axis of robots before that of trials, of length 1 if they share the delay.
    late = whole[:, 0, 0] if whole.ndim else whole.reshape(1)
    padded = np.concatenate([np.zeros_like(command_V[:1]), command_V])
    new_V, old_V = (padded[np.maximum(rows[:, None] + due - late, 0)] for due in (1, 0))
    begin = begin_s + row_s * rows[:, None, None, None]
    is_cut = np.any(rest_s > 0.0) & np.any(old_V != new_V, axis=(1, 2, 3))
    before_V = _held_before(driveline, new_V, old_V, durations, is_cut)
    last_V, mean_V = (driveline.of_battery_V(volts, begin) for volts in driveline.lagged_V(before_V, new_V, row_s))
    new_trend, old_trend = voltage_trend(new_V), np.ones_like(new_V)
    old_trend[1:] = new_trend[:-1]
    values = (mean_V, begin, last_V, before_V, old_V, new_V, old_trend, new_trend)
    by_row = [list(_without_robots(each)) for each in values]
    heat: float | Array = 0.0
    for cut, mean, since, last, before, old, new, trend_before, trend in zip(is_cut.tolist(), *by_row, strict=True):
        if cut:
            row = _cut_row(driveline, before, (old, new), since, durations, (trend_before, trend), heat)
        else:
            supply = driveline.supply_V(since)
            heat_after = driveline.heat_after(heat, mean, row_s)
            row = HeldRow((HeldPart(mean, supply, since, row_s, trend, heat),), last, supply, heat_after)
        heat = row.last_heat
        yield row


def _held_before(
    driveline: Driveline, new_V: Array, old_V: Array, durations: _Durations, is_cut: NDArray[np.bool_]
) -> Array:
    """Return the state of a lag before each row, (T, M, N, wheels) or broadcast to it; unused if nothing lags."""
    if not driveline.lags:
        return new_V
    held_V, states_V = np.zeros_like(new_V[0]), []
    for new, old, cut in zip(new_V, old_V, is_cut.tolist(), strict=True):
        states_V.append(held_V)
        held_V = driveline.held_V(held_V, old, durations.before_s) if cut else held_V
        held_V = driveline.held_V(held_V, new, durations.after_s if cut else durations.whole_s)
    return stacked_rows(states_V)


def _cut_row(  # noqa: PLR0917 - the motors, and all that changes within the row
    driveline: Driveline,
    held_V: Array,
    command_V: tuple[Array, Array],
    begin_s: Array,
    durations: _Durations,
    trends: tuple[Array, Array],
    heat: float | Array,
) -> HeldRow:
    """Return a row in which the command of the previous row is followed by its own; `heat` is that at its beginning."""
    old_V, new_V = command_V
    old_last_V, old_mean_V = driveline.lagged_V(held_V, old_V, durations.before_s)
    held_V, mean_V = driveline.lagged_V(old_last_V, new_V, durations.after_s)
    # A mean over the end of the row in place of its last value, so that it changes smoothly with the delay.
    last_V = held_V + np.clip(1.0 - durations.after_s / LAST_S, 0.0, 1.0) * (old_last_V - held_V)
    periods = ((old_mean_V, begin_s, durations.before_s), (mean_V, begin_s + durations.before_s, durations.after_s))
    parts = []
    for (volts, time, duration), trend in zip(periods, trends, strict=True):
        voltage_V = driveline.of_battery_V(volts, time)
        parts.append(HeldPart(voltage_V, driveline.supply_V(time), time, duration, trend, heat))
        heat = driveline.heat_after(heat, voltage_V, duration)
    return HeldRow(tuple(parts), driveline.of_battery_V(last_V, begin_s), driveline.supply_V(begin_s), heat)


def _without_robots(values: Array) -> Array:
    """Return (T, N, wheels) if the axis of robots of (T, M, N, wheels) has length 1."""
    return values[:, 0] if values.shape[1] == 1 else values
