"""Limits of the next trial, with defaults from the measurement."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.next_trial.template import template_of
from symolo.core.errors import InputError

SECONDS = 15.0
ROW_S = 3.0
"""Time of a row if that of the case is not known."""
ALWAYS = ("--seconds", "--rows", "--row-seconds")
"""Options of `symolo next` that every kind of case uses."""
OF_MOTORS = ("--max-voltage", "--one-direction")
OF_RANGES = ("--distances",)
MIN_ROWS = 2
MAX_ROWS = 400
RUN_S = 3.0
"""Duration of one run of a step log: long compared with the time constants of small motors."""


@dataclass(frozen=True)
class Limits:
    """Limits of a trial."""

    seconds: float
    """Time of the whole trial, without the pauses between its runs."""
    row_s: float
    """Time of one row of a bench, or of one run of a step log."""
    max_voltage_V: float
    one_direction: bool
    """Whether the motor must not be reversed."""
    distances_m: tuple[float, float]
    """Shortest and longest distance of a range bench."""

    @property
    def units(self) -> int:
        """Number of rows or runs."""
        return int(self.seconds / self.row_s + 1e-6)


def limits_of(
    measurement: Measurement,
    *,
    seconds: float | None = None,
    rows: int | None = None,
    row_s: float | None = None,
    max_voltage_V: float | None = None,
    one_direction: bool = False,
    distances_m: tuple[float, float] | None = None,
) -> Limits:
    """Return limits for a measurement; those that are None have their defaults.

    Args:
        measurement: The old data.
        seconds: Time of the trial; 15 s by default.
        rows: Number of rows or runs in place of the time.
        row_s: Time of a row or a run; that of the old data by default.
        max_voltage_V: Highest voltage; by default the largest of the old data, of either sign.
        one_direction: Whether the motor must not be reversed.
        distances_m: Shortest and longest distance; those of the old data by default.

    Raises:
        InputError: A limit leaves no trial, or has no meaning for such data.
    """
    template = template_of(measurement)
    of_motors = zip(OF_MOTORS, (max_voltage_V is not None, one_direction), strict=True)
    _check_used(template.kind, [*(name for name, is_set in of_motors if is_set), *OF_RANGES[: distances_m is not None]])
    row_s = row_s or _row_s(template, seconds or SECONDS)
    seconds = rows * row_s if rows is not None else (seconds or SECONDS)
    voltage_V, distance_m = (_reach(template, name) for name in ("u_cmd_V", "distance_m"))
    limits = Limits(
        seconds,
        row_s,
        max_voltage_V or float(np.abs(voltage_V).max()),
        one_direction,
        distances_m or (float(distance_m.min()), float(distance_m.max())),
    )
    min_rows = 1 if template.kind is CaseKind.MOTOR_STEP else MIN_ROWS
    if not min_rows <= limits.units <= MAX_ROWS:
        cure = "change --seconds or --row-seconds, or give --rows"
        what = f"{limits.seconds:g} s with {limits.row_s:g} s for each row or run"
        raise InputError(what, got=f"{limits.units} rows or runs", allowed=f"{min_rows} to {MAX_ROWS}", cure=cure)
    if limits.distances_m[0] > limits.distances_m[1]:
        raise InputError("--distances", got=f"{limits.distances_m[0]:g} above {limits.distances_m[1]:g}")
    return limits


def _check_used(kind: CaseKind, options: Sequence[str]) -> None:
    """Refuse options that a kind of case does not use."""
    used = (*ALWAYS, *(OF_RANGES if kind is CaseKind.TOF_BENCH else OF_MOTORS))
    for option in options:
        if option not in used:
            raise InputError(f"{option} is not used for a case of kind {kind}", allowed=", ".join(used))


def _row_s(template: Measurement, seconds: float) -> float:
    """Return the usual time of a row, or the duration of a run."""
    if template.kind is CaseKind.MOTOR_STEP:
        return min(RUN_S, seconds)
    steps = np.concatenate([np.diff(trial.t_s) for trial in template.trials if trial.is_timed] or [np.empty(0)])
    return round(float(np.median(steps)), 3) if len(steps) else ROW_S


def _reach(template: Measurement, name: str) -> np.ndarray:
    """Return the known values of an input of the old data; 0 if it has no such input."""
    if name not in template.channel_names():
        return np.zeros(1)
    values = np.concatenate([channel.values for channel in template.across(name)])
    return values[np.isfinite(values)]
