"""Notes on what is probably wrong in a drive: gaps, jumping counters, and wheels that do not belong to the pose."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.importers.cases.motor_checks import goes_against, speed_checks
from diagnosis.measured.case_files.nominal import NominalMotor
from diagnosis.measured.channel import Role
from diagnosis.measured.measurement import CHECK, Measurement, Trial
from diagnosis.measured.pose_by_ticks import MIN_SHARE, PoseByTicks, pose_by_ticks
from logs.columns.drive import COUNTED
from logs.counts import jump_note
from logs.mapping import MAPPING
from logs.times import gap_note
from symolo.core.arrays import Array

MIN_GAP_STEPS = 10.0
"""Smallest gap that is noted, in usual steps: half a second."""
FAR_OFF = 1.4
"""Ratio of the distances of pose and wheels from which on a number of the wheels is wrong; no wheel slips as much."""
DRIVEN, MIN_BACKWARD_ROWS = 0.3, 10
"""Share of the largest voltage, and of the usual speed at such voltages, from which on a wheel is driven, and rows in
which it turns backwards all the same that no push explains."""
EDGES = (2.0, 4.0)
"""Counts per pulse of an encoder, by how many edges of its two channels are counted."""


@dataclass(frozen=True)
class CountedWheels:
    """Numbers of a robot by which ticks become distances."""

    radius_m: float
    ticks_per_turn: float
    track_m: float


def drive_checks(
    wheels: CountedWheels, measurement: Measurement, motor: NominalMotor | None = None, *, has_wrong_unit: bool = False
) -> Iterator[str]:
    """Yield a note for each sign that the log, its mapping or the numbers of the robot are wrong.

    With a wrong unit or a jumping counter, pose and wheels contradict each other in any case, so that only the cause is
    noted.

    Args:
        wheels: Numbers of the robot.
        measurement: The drive.
        motor: Numbers of its motors; None if they are not known.
        has_wrong_unit: Whether another note says that a unit is wrong.
    """
    has_cause = has_wrong_unit
    for trial in measurement.trials:
        where = f"trial {trial.name}: " if len(measurement.trials) > 1 else ""
        readings = [channel.values for channel in trial.channels if channel.role is Role.READING]
        known = np.isfinite(readings).any(axis=0)
        if gap := gap_note(trial.t_s[known], MIN_GAP_STEPS):
            yield f"{where}{gap}"
        for name in COUNTED if measurement.has(*COUNTED) else ():
            if note := jump_note(f"{where}{name}", trial[name].values, trial.t_s):
                has_cause = True
                yield f"{CHECK} {note}"
    if has_cause:
        return
    moved = pose_by_ticks(measurement)
    contradictions = list(moved.contradictions()) if moved else []
    yield from (f"{CHECK} {text}" for text in contradictions)
    if contradictions:
        return
    signs = list(_voltage_notes(measurement, agree_with_pose=moved is not None and moved.is_explained))
    signs = signs or list(_sign_notes(measurement))
    yield from signs
    travel = list(_travel_note(wheels, moved)) if moved is not None else []
    yield from travel
    if motor is not None and not signs and not travel:
        yield from _speed_notes(motor, wheels, measurement)
    if moved is not None and not travel and moved.is_turn_clear:
        yield from _turn_note(wheels, moved.span_rad_per_tick)


def _voltage_notes(measurement: Measurement, *, agree_with_pose: bool) -> Iterator[str]:
    """Yield a note for each wheel that turns against its voltage.

    A motor takes power over a whole drive, so that the sum of voltage times speed is not negative.

    Args:
        measurement: The drive.
        agree_with_pose: Whether the ticks agree with the poses, so that their signs are right.
    """
    if _are_exchanged(measurement):
        also = "" if agree_with_pose else ", or the counts"
        yield f"{CHECK} u_left_V and u_right_V: each wheel follows the voltage of the other one; exchange them{also}"
        return
    for side in ("left", "right"):
        voltage, ticks = f"u_{side}_V", f"enc_{side}_ticks"
        if not measurement.has(voltage, ticks):
            continue
        rows = np.concatenate([_held_and_moved(trial, voltage, ticks) for trial in measurement.trials])
        if goes_against(*rows.T):
            cure = f"give {voltage} factor: -1" if agree_with_pose else "give the one with the wrong sign factor: -1"
            yield (
                f"{CHECK} {voltage} and {ticks}: the {side} wheel turns against its voltage; {cure}, or exchange left "
                "and right if both wheels do so"
            )


def _sign_notes(measurement: Measurement) -> Iterator[str]:
    """Yield a note for each wheel that turns backwards at voltages that are never below zero."""
    for side in ("left", "right"):
        voltage, ticks = f"u_{side}_V", f"enc_{side}_ticks"
        if not measurement.has(voltage, ticks):
            continue
        rows = np.concatenate([_held_and_moved(trial, voltage, ticks) for trial in measurement.trials])
        u_V, moved = rows[np.isfinite(rows).all(axis=1)].T
        if not len(u_V) or u_V.min() < 0.0:
            continue
        # Driven clearly, and as fast as usual: a wheel that is pushed back or rolls on is neither.
        is_driven = u_V > DRIVEN * u_V.max()
        fast = DRIVEN * float(np.median(np.abs(moved[is_driven]))) if is_driven.any() else np.inf
        back = np.count_nonzero(is_driven & (moved < -max(fast, 1.0)))
        if back >= MIN_BACKWARD_ROWS:
            yield (
                f"{CHECK} {voltage} is never below 0, but the {side} wheel turns backwards in {back} rows that have a"
                f" voltage: the log has it without its sign; name the column that states the sense as direction in"
                f" {MAPPING}, with its values backwards: [VALUE]"
            )


def _speed_notes(motor: NominalMotor, wheels: CountedWheels, measurement: Measurement) -> Iterator[str]:
    """Yield a note for the first motor that turns much faster or slower than its voltage lets it turn without load."""
    for side in ("left", "right"):
        voltage, ticks = f"u_{side}_V", f"enc_{side}_ticks"
        if not measurement.has(voltage, ticks):
            continue
        rows = np.concatenate([_held_and_moved(trial, voltage, ticks) for trial in measurement.trials])
        steps_s = np.concatenate([np.diff(trial.t_s) for trial in measurement.trials])
        speed_rad_s = 2.0 * np.pi / wheels.ticks_per_turn * rows[:, 1] / steps_s
        known = np.isfinite(rows[:, 0] + speed_rad_s)
        notes = list(speed_checks(motor, rows[known, 0], speed_rad_s[known], voltage))
        yield from notes
        if notes:
            return


def _are_exchanged(measurement: Measurement) -> bool:
    """Return whether the wheels turn together with the sum of both voltages, but apart against their difference."""
    if not measurement.has("u_left_V", "u_right_V", "enc_left_ticks", "enc_right_ticks"):
        return False
    rows = np.concatenate(
        [
            np.hstack([_held_and_moved(trial, f"u_{side}_V", f"enc_{side}_ticks") for side in ("left", "right")])
            for trial in measurement.trials
        ]
    )
    left_V, left, right_V, right = rows[np.isfinite(rows).all(axis=1)].T
    apart, sums = (right_V - left_V, right - left), (right_V + left_V, right + left)
    return goes_against(*apart) and goes_against(sums[0], -sums[1])


def _held_and_moved(trial: Trial, voltage: str, ticks: str) -> Array:
    """Return (N, 2), the voltage from each row to the next, and the ticks by which the wheel turns meanwhile."""
    return np.stack([trial[voltage].values[:-1], np.diff(trial[ticks].values)], axis=1)


def _travel_note(wheels: CountedWheels, moved: PoseByTicks) -> Iterator[str]:
    """Yield a note if the pose moves much farther than the wheels, or much less far."""
    if not moved.is_forward_clear or moved.forward_share < MIN_SHARE:
        return
    ticks, radius_m = wheels.ticks_per_turn, wheels.radius_m
    ratio = moved.span_m_per_tick * ticks / (2.0 * np.pi * radius_m)
    if 1.0 / FAR_OFF < ratio < FAR_OFF:
        return
    more = next((each for each in (*EDGES, *(1.0 / edges for edges in EDGES)) if 0.85 < ratio * each < 1.15), None)
    would = f"{ticks / ratio:.0f}"
    if more:
        would = f"{ticks * more:g}, {more:g} times as many, as if other edges were counted"
    yield (
        f"{CHECK} ticks_per_turn and wheel_diameter_m: the pose moves {ratio:.3g} times as far as the wheels; it would "
        f"fit with ticks_per_turn {would}, or with a wheel diameter of {2.0 * radius_m * ratio:.3g} m"
    )


def _turn_note(wheels: CountedWheels, rad_per_tick: float) -> Iterator[str]:
    """Yield a note if the heading turns much farther than the wheels, or much less far, though the path agrees."""
    ratio = rad_per_tick * wheels.ticks_per_turn * wheels.track_m / (2.0 * np.pi * wheels.radius_m)
    if 1.0 / FAR_OFF < ratio < FAR_OFF:
        return
    half = {0.5: ", twice as much, as if half of it was given", 2.0: ", half as much, as if twice of it was given"}
    often = next((text for each, text in half.items() if 0.85 < ratio / each < 1.15), "")
    yield (
        f"{CHECK} track_m: theta_rad turns {ratio:.3g} times as far as the wheels; it would fit with a distance of "
        f"{wheels.track_m / ratio:.3g} m between the wheels{often}"
    )
