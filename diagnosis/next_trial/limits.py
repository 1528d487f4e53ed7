"""Limits of the next trial, with defaults from the measurement."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.importers.drive_log import fastest
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.next_trial.template import floor_of, nominal_drive, reachable_m_s, template_of
from symolo.core.errors import InputError

SECONDS = 15.0
ROW_S = 3.0
"""Time of a row if that of the case is not known."""
ALWAYS = ("--seconds", "--rows", "--row-seconds")
"""Options of `symolo next` that every kind of case uses."""
MOTOR_OPTIONS = ("--max-voltage", "--one-direction")
RANGE_OPTIONS = ("--distances",)
DRIVE_OPTIONS = ("--floor", "--max-speed")
MIN_ROWS = 2
MAX_ROWS = 400
RUN_S = 3.0
"""Duration of one run of a step log: long compared with the time constants of small motors."""
MANOEUVRE_S = 5.0
"""Duration of one manoeuvre of a drive: enough for a square."""
MIN_MANOEUVRE_S = 2.0


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
    floor_m: tuple[float, float] = (0.0, 0.0)
    """Size of the free floor of a drive along x and y."""
    middle_m: tuple[float, float] = (0.0, 0.0)
    """Middle of the free floor, in the frame of the old poses."""
    max_speed_m_s: float = 0.0
    """Highest speed of a wheel over the floor."""
    max_turn_rad_s: float = 0.0
    """Highest yaw rate of a drive."""
    drift_m: float = 0.0
    """Distance from the border that is kept because the robot may leave the planned path."""

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
    floor_m: tuple[float, float] | None = None,
    max_speed_m_s: float | None = None,
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
        floor_m: Size of the free floor along x and y; that of the old drives by default.
        max_speed_m_s: Highest speed of a wheel over the floor; that of the old drives by default.

    Raises:
        InputError: A limit leaves no trial, or has no meaning for such data.
    """
    template = template_of(measurement)
    names = (*MOTOR_OPTIONS, *RANGE_OPTIONS, *DRIVE_OPTIONS)
    numbers = (max_voltage_V, one_direction or None, distances_m, floor_m, max_speed_m_s)
    _check_used(template.kind, [name for name, value in zip(names, numbers, strict=True) if value is not None])
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
    if template.kind is CaseKind.DRIVE_LOG:
        limits = _drive_limits(template, limits, floor_m, max_speed_m_s)
    min_rows = 1 if template.kind in {CaseKind.MOTOR_STEP, CaseKind.DRIVE_LOG} else MIN_ROWS
    if not min_rows <= limits.units <= MAX_ROWS:
        cure = "change --seconds or --row-seconds, or give --rows"
        what = f"{limits.seconds:g} s with {limits.row_s:g} s for each row or run"
        raise InputError(what, got=f"{limits.units} rows or runs", allowed=f"{min_rows} to {MAX_ROWS}", cure=cure)
    if limits.distances_m[0] > limits.distances_m[1]:
        raise InputError("--distances", got=f"{limits.distances_m[0]:g} above {limits.distances_m[1]:g}")
    return limits


def _drive_limits(
    template: Measurement, limits: Limits, floor_m: tuple[float, float] | None, max_speed_m_s: float | None
) -> Limits:
    """Return the limits with those of a drive.

    Raises:
        InputError: A manoeuvre is too short, the old robot never moved, or the floor is larger than the room.
    """
    if limits.row_s < MIN_MANOEUVRE_S:
        cure = "give more time with --row-seconds"
        raise InputError(f"{limits.row_s:g} s for a manoeuvre", allowed=f"at least {MIN_MANOEUVRE_S:g} s", cure=cure)
    speed_m_s, turn_rad_s = fastest(template)
    if not speed_m_s > 0.0:
        raise InputError("the wheels do not turn in the old data", cure="give the highest speed with --max-speed")
    reachable = reachable_m_s(template)
    if max_speed_m_s is not None and max_speed_m_s > reachable:
        what = f"{max_speed_m_s:g} m/s, which the nominal motors do not reach"
        raise InputError("--max-speed", got=what, allowed=f"up to {reachable:.3g} m/s")
    middle_m, old_m = floor_of(template)
    room = nominal_drive(template).world
    if floor_m is not None and room is not None and (floor_m[0] > old_m[0] or floor_m[1] > old_m[1]):
        allowed = "up to {:g}x{:g}, the room of nominal.yaml".format(*old_m)
        raise InputError("--floor", got="{:g}x{:g}".format(*floor_m), allowed=allowed)
    return replace(
        limits,
        floor_m=floor_m or old_m,
        middle_m=middle_m,
        max_speed_m_s=max_speed_m_s or speed_m_s,
        # Wheels that went straight on so far may turn the robot on the spot at half their speed.
        max_turn_rad_s=max(turn_rad_s, speed_m_s / nominal_drive(template).robot.wheel_separation_m.value),
    )


def _check_used(kind: CaseKind, options: Sequence[str]) -> None:
    """Refuse options that a kind of case does not use."""
    used = (*ALWAYS, *{CaseKind.TOF_BENCH: RANGE_OPTIONS, CaseKind.DRIVE_LOG: DRIVE_OPTIONS}.get(kind, MOTOR_OPTIONS))
    for option in options:
        if option not in used:
            raise InputError(f"{option} is not used for a case of kind {kind}", allowed=", ".join(used))


def _row_s(template: Measurement, seconds: float) -> float:
    """Return the usual time of a row, or the duration of a run."""
    if template.kind is CaseKind.MOTOR_STEP:
        return min(RUN_S, seconds)
    if template.kind is CaseKind.DRIVE_LOG:
        return min(MANOEUVRE_S, seconds)
    steps = np.concatenate([np.diff(trial.t_s) for trial in template.trials if trial.is_timed] or [np.empty(0)])
    return round(float(np.median(steps)), 3) if len(steps) else ROW_S


def _reach(template: Measurement, name: str) -> np.ndarray:
    """Return the known values of an input of the old data; 0 if it has no such input."""
    if name not in template.channel_names():
        return np.zeros(1)
    values = np.concatenate([channel.values for channel in template.across(name)])
    return values[np.isfinite(values)]
