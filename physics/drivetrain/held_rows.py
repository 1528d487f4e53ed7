"""Voltages at the motors for commands that are held in each row (zero-order hold), after delay, lag and battery.

A row is divided where a delayed command takes effect, so that results change smoothly with the delay. Rows may last
unequally long. A command whose delay ends in the row before or after the one where it would in even rows then takes
effect at the beginning or the end of that one.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physics.drivetrain.driveline import NO_PLACE, Driveline, Place
from physics.drivetrain.motion import voltage_trend
from symolo.core.arrays import Array, stacked_rows

LAST_S = 5e-4
"""Length of the end of a row over which `HeldRow.last_V` is a mean."""


class HeldPart(NamedTuple):
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
    place_m: Place = NO_PLACE
    """x and y of the robot in W."""


class HeldRow(NamedTuple):
    """Voltages at the motors during one row; all broadcast, wheels along the last axis."""

    parts: tuple[HeldPart, ...]
    """Parts of the row: one, or two if a delayed command takes effect within the row."""
    last_V: Array
    """Voltage at the end of the row."""
    supply_V: float | Array
    """Voltage of the supply without load, at the beginning of the row."""
    last_heat: float | Array
    """Share by which heat has raised the resistance at the end of the row."""


@dataclass(frozen=True)
class Durations:
    """Durations of T rows and of their parts before and after a delayed command takes effect."""

    whole_s: float | Array
    """One for all rows, or (T, ...)."""
    before_s: float | Array
    """As `whole_s`, or one for each delay."""
    after_s: float | Array
    differ: bool = False
    """Whether each row has durations of its own, along the first axis."""

    @classmethod
    def from_rows(
        cls, row_s: float | Array, begins_s: Array, delay_s: float | Array
    ) -> tuple["Durations", NDArray[np.int64]]:
        """Return the durations, and the number of rows (M,) or (1,) by which commands are late as well.

        Args:
            row_s: Duration of the rows, one or (T, 1, N, 1).
            begins_s: (T, 1, N, 1), beginnings of the rows.
            delay_s: Delay of commands; a number, or one of each robot as (M, 1, 1), (M, N, 1) or (M, N, wheels).
        """
        whole = np.floor(np.divide(delay_s, np.median(row_s))).astype(np.int64)
        # An axis of robots before that of trials, of length 1 if they share the delay.
        late = whole[:, 0, 0] if whole.ndim else whole.reshape(1)
        if not isinstance(row_s, np.ndarray):
            rest_s = delay_s - whole * row_s
            return cls(row_s, rest_s, row_s - rest_s), late
        rows = np.arange(len(begins_s))[:, None]
        begun_s = begins_s - begins_s[np.maximum(rows - late, 0), 0]
        before_s = np.clip(delay_s - begun_s, 0.0, row_s)
        return cls(row_s, before_s, row_s - before_s, differ=True), late

    def at(self, rows: int | NDArray[np.bool_]) -> "Durations":
        """Return those of some rows, or of one."""
        if not self.differ:
            return self
        whole_s, before_s, after_s = (np.asarray(each)[rows] for each in (self.whole_s, self.before_s, self.after_s))
        return Durations(whole_s, before_s, after_s, differ=True)

    def without_robots(self) -> "Durations":
        """Return the same without an axis of robots of length 1."""
        if not self.differ:
            return self
        return Durations(
            *(_without_robots(np.asarray(each)) for each in (self.whole_s, self.before_s, self.after_s)), differ=True
        )


def joined_parts(parts: Iterable[HeldPart]) -> Iterator[HeldPart]:
    """Yield successive periods, those with equal voltages as one."""
    whole: HeldPart | None = None
    for part in parts:
        if whole is None:
            whole = part
        elif _is_like(part, whole):
            whole = whole._replace(duration_s=whole.duration_s + part.duration_s)
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


@dataclass(frozen=True)
class HeldVoltages:
    """Voltages at the motors in T rows, C of which are cut where a delayed command takes effect.

    The axis of the robots, before that of the trials, is missing where all robots have the same values.
    """

    durations: Durations
    begin_s: Array
    """(T, N, wheels), beginning of each row, since the motors were first switched on."""
    cut: NDArray[np.int64]
    """(T,), place of a row among the cut ones; -1 for a whole one."""
    mean_V: Array
    """(T, ...), mean voltage of each whole row."""
    old_V: Array
    """(C, ...), mean voltage of each cut row before the command takes effect."""
    new_V: Array
    """(C, ...), the same afterwards."""
    last_V: Array
    """(T, ...), voltage at the end of each row."""
    old_trend: Array
    """(T, ...), trend of the voltage before the command takes effect."""
    new_trend: Array

    @classmethod
    def from_commands(
        cls, driveline: Driveline, command_V: Array, row_s: float | Array, delay_s: float | Array, begin_s: Array
    ) -> "HeldVoltages":
        """Return the voltages for commands that are 0 V before the first; arguments are those of `held_rows`."""
        rows = np.arange(len(command_V))
        if isinstance(row_s, np.ndarray):
            row_s = row_s[:, None]
            begin = begin_s + np.cumsum(row_s, axis=0) - row_s
        else:
            begin = begin_s + row_s * rows[:, None, None, None]
        durations, late = Durations.from_rows(row_s, begin, delay_s)
        padded = np.concatenate([np.zeros_like(command_V[:1]), command_V])
        new_V, old_V = (padded[np.maximum(rows[:, None] + due - late, 0)] for due in (1, 0))
        is_cut = np.any(np.asarray(durations.before_s) > 0.0) & np.any(old_V != new_V, axis=(1, 2, 3))
        before_V = _held_before(driveline, new_V, old_V, durations, is_cut)
        last_V, mean_V = (
            driveline.battery_voltage_V(volts, begin) for volts in driveline.lagged_V(before_V, new_V, row_s)
        )
        old_mean_V, new_mean_V = mean_V[:0], mean_V[:0]
        if is_cut.any():
            old_mean_V, new_mean_V, last_of_cut_V = _cut_voltages(
                driveline, (before_V[is_cut], old_V[is_cut], new_V[is_cut]), begin[is_cut], durations.at(is_cut)
            )
            last_V = np.broadcast_to(last_V, (len(last_V), *last_of_cut_V.shape[1:])).copy()
            last_V[is_cut] = last_of_cut_V
        new_trend, old_trend = voltage_trend(new_V), np.ones_like(new_V)
        old_trend[1:] = new_trend[:-1]
        row_values = (begin, mean_V, old_mean_V, new_mean_V, last_V, old_trend, new_trend)
        begin, mean_V, old_mean_V, new_mean_V, last_V, old_trend, new_trend = map(_without_robots, row_values)
        return cls(
            durations=durations.without_robots(),
            begin_s=begin,
            cut=np.where(is_cut, np.cumsum(is_cut) - 1, -1),
            mean_V=mean_V,
            old_V=old_mean_V,
            new_V=new_mean_V,
            last_V=last_V,
            old_trend=old_trend,
            new_trend=new_trend,
        )


def held_rows(
    driveline: Driveline, command_V: Array, row_s: float | Array, delay_s: float | Array, begin_s: Array
) -> Iterator[HeldRow]:
    """Yield the voltages of each row; commands are 0 V before the first.

    Args:
        driveline: Motors of one robot, or of M.
        command_V: (T, N, wheels), each constant for its row.
        row_s: Duration of a row, one for all or (T, N, 1).
        delay_s: Delay of commands; a number, or one of each robot as (M, 1, 1), (M, N, 1) or (M, N, wheels).
        begin_s: (N, 1), time of each trial's start since the motors were first switched on.
    """
    held = HeldVoltages.from_commands(driveline, command_V, row_s, delay_s, begin_s)
    by_row = (list(each) for each in (held.mean_V, held.begin_s, held.last_V, held.old_trend, held.new_trend))
    heat: float | Array = 0.0
    for row, (place, mean, begin, last, old_trend, new_trend) in enumerate(
        zip(held.cut.tolist(), *by_row, strict=True)
    ):
        lasts = held.durations.at(row)
        periods = ((mean, begin, lasts.whole_s, new_trend),)
        if place >= 0:
            since = begin + lasts.before_s
            before = held.old_V[place], begin, lasts.before_s, old_trend
            periods = (before, (held.new_V[place], since, lasts.after_s, new_trend))
        parts = []
        for volts, time, duration, trend in periods:
            parts.append(HeldPart(volts, driveline.supply_V(time), time, duration, trend, heat))
            heat = driveline.heat_after(heat, volts, duration)
        yield HeldRow(tuple(parts), last, parts[0].supply_V, heat)


def _held_before(
    driveline: Driveline, new_V: Array, old_V: Array, durations: Durations, is_cut: NDArray[np.bool_]
) -> Array:
    """Return the state of a lag before each row, (T, M, N, wheels) or broadcast to it; unused if nothing lags."""
    if not driveline.lags:
        return new_V
    held_V, states_V = np.zeros_like(new_V[0]), []
    for row, (new, old, cut) in enumerate(zip(new_V, old_V, is_cut.tolist(), strict=True)):
        states_V.append(held_V)
        lasts = durations.at(row)
        held_V = driveline.held_V(held_V, old, lasts.before_s) if cut else held_V
        held_V = driveline.held_V(held_V, new, lasts.after_s if cut else lasts.whole_s)
    return stacked_rows(states_V)


def _cut_voltages(
    driveline: Driveline, voltages_V: tuple[Array, Array, Array], begin_s: Array, durations: Durations
) -> tuple[Array, Array, Array]:
    """Return the mean voltages of cut rows before and after the command takes effect, and the voltages at their ends.

    Args:
        driveline: The motors.
        voltages_V: State of a lag before each row, the command of the row before, and that of the row, (C, ...) each.
        begin_s: (C, ...), beginning of each row.
        durations: Those of the parts.
    """
    before_V, old_V, new_V = voltages_V
    old_last_V, old_mean_V = driveline.lagged_V(before_V, old_V, durations.before_s)
    held_V, mean_V = driveline.lagged_V(old_last_V, new_V, durations.after_s)
    # A mean over the end of the row in place of its last value, so that it changes smoothly with the delay.
    last_V = held_V + np.clip(1.0 - durations.after_s / LAST_S, 0.0, 1.0) * (old_last_V - held_V)
    since_s = begin_s + durations.before_s
    supply_V = driveline.battery_voltage_V
    return supply_V(old_mean_V, begin_s), supply_V(mean_V, since_s), supply_V(last_V, begin_s)


def _without_robots(values: Array) -> Array:
    """Return (T, N, wheels) if the axis of robots of (T, M, N, wheels) has length 1."""
    return values[:, 0] if values.shape[1] == 1 else values
