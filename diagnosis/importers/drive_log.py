"""Voltages, encoder counts, ranges and camera pose of a driving robot (a measured case)."""

from collections.abc import Sequence

import numpy as np

from diagnosis.importers.cases.case import case_importer, scale_note
from diagnosis.importers.cases.drive_checks import CountedWheels, drive_checks
from diagnosis.importers.cases.motor_checks import number_checks
from diagnosis.importers.cases.range_checks import range_checks
from diagnosis.importers.cases.trials import KnownNoise
from diagnosis.importers.motor_step import check_rate
from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.early_response import early_response_note
from diagnosis.measured.measurement import CHECK, CHECK_UNIT, CaseKind, Measurement, Trial
from diagnosis.measured.pose_by_ticks import pose_by_ticks
from logs.units.wrapped_angles import BEYOND_RAD
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError
from symolo.core.tables.table import CsvTable

ROW_S = 0.05
"""Time between two rows of this kind of case."""
WRAP_WITHIN_RAD = 1.0
"""Largest difference of a jump from a whole turn for which it is a wrapped angle."""
LONGEST_STEP_S = 0.25
"""Time between two rows in which no robot makes a whole turn."""
HALF_SECOND_ROWS = round(0.5 / ROW_S)


def _noise(nominal: NominalDrive, table: CsvTable, name: str) -> KnownNoise | None:
    """Return the stated noise of the pose. That of a range depends on the true distance, which is not logged."""
    if name in {"x_m", "y_m"}:
        return KnownNoise.constant(nominal.noise.pose_xy_m, table)
    return KnownNoise.constant(nominal.noise.pose_theta_rad, table) if name == "theta_rad" else None


def _notes(nominal: NominalDrive, measurement: Measurement) -> Sequence[str]:
    faults = FaultList()
    with faults.noted():
        check_rate(measurement, ROW_S)
    with faults.noted():
        _check_heading(measurement)
    distance_m = np.linspace(0.0, nominal.tof.max_range_m if nominal.tof else 0.0, 1000)
    with faults.noted():
        nominal.noise.tof.check(distance_m, field="noise.tof_polynomial_mm", where=measurement.source.files[1])
    faults.check()
    moved = pose_by_ticks(measurement)
    # With the wrong sign of a count, the wheels seem to travel as in another unit.
    units = [] if moved is not None and moved.has_wrong_sign else _travel_notes(nominal, measurement)
    robot = nominal.robot
    wheels = CountedWheels(
        robot.wheel_radius_m.value, robot.encoder_ticks_per_revolution, robot.wheel_separation_m.value
    )
    checks = list(drive_checks(wheels, measurement, nominal.motor, has_wrong_unit=bool(units)))
    has_wrong_unit = units or any(note.startswith(CHECK_UNIT) for note in checks)
    has_wrong_pose = units or any(note.startswith(CHECK) for note in checks)
    ranges = [] if has_wrong_pose else range_checks(nominal, measurement)
    numbers = number_checks(nominal.motor, checks) if nominal.motor and not has_wrong_unit else ()
    return [*_left_out(nominal, measurement), *units, *checks, *numbers, *ranges, *early_response_note(measurement)]


def _left_out(nominal: NominalDrive, measurement: Measurement) -> list[str]:
    """Return a note for each stage that is not compared because nominal.yaml lacks a section."""
    notes = []
    if nominal.motor is None and measurement.has("u_left_V"):
        notes.append("nominal.yaml has no section motor: speeds are not compared with voltages")
    ranges = [side for side in RANGE_SIDES if measurement.has(f"tof_{side}_m")]
    lacking = [name for name, section in (("tof", nominal.tof), ("world", nominal.world)) if section is None]
    if ranges and lacking:
        notes.append(f"nominal.yaml has no section {' and '.join(lacking)}: ranges are not compared")
    elif nominal.tof is not None:
        without = [side for side in ranges if getattr(nominal.tof.mount, side) is None]
        notes += [f"nominal.yaml has no tof.mount.{side}: the ranges tof_{side}_m are not compared" for side in without]
    return notes


def _check_heading(measurement: Measurement) -> None:
    """Refuse a heading that is wrapped to one turn, recognised by jumps of about a whole turn between two rows.

    Raises:
        InputError: The heading is wrapped; the message names the row of the first jump.
    """
    row = 2  # below the header
    for trial in measurement.trials:
        theta = trial["theta_rad"].values
        known = np.flatnonzero(np.isfinite(theta))
        turned = np.diff(theta[known])
        jumps = (np.abs(np.abs(turned) - 2.0 * np.pi) < WRAP_WITHIN_RAD) & (np.diff(trial.t_s[known]) < LONGEST_STEP_S)
        # Where most steps are as large as a turn, or values lie beyond one, the column is in another unit, and a note
        # says so.
        is_within_turn = np.abs(theta[known]).max(initial=0.0) <= BEYOND_RAD
        if jumps.any() and is_within_turn and np.median(np.abs(turned)) < WRAP_WITHIN_RAD:
            before, i = known[int(np.argmax(jumps)) :][:2].tolist()
            raise InputError(
                f"column theta_rad: goes from {theta[before]:.6g} to {theta[i]:.6g}",
                where=f"{measurement.source.files[0]}: row {row + i}",
                cure="unwrap the angle, so that it continues beyond a whole turn",
            )
        row += len(theta)


def _travel_notes(nominal: NominalDrive, measurement: Measurement) -> list[str]:
    """Return a note if the pose travels or turns so much more than the wheels that it looks like another unit."""
    robot = nominal.robot
    per_tick = 2.0 * np.pi * robot.wheel_radius_m.value / robot.encoder_ticks_per_revolution
    by_pose, by_wheels = np.zeros(2), np.zeros(2)
    for trial in measurement.trials:
        left, right = (per_tick * _net(trial, f"enc_{side}_ticks") for side in ("left", "right"))
        turned = np.abs(right - left) / robot.wheel_separation_m.value
        x, y, theta = (_net(trial, name) for name in ("x_m", "y_m", "theta_rad"))
        both = np.isfinite(x + y + left + right)
        by_pose += np.hypot(x, y)[both].sum(), np.abs(theta)[both & np.isfinite(theta)].sum()
        by_wheels += np.abs(left + right)[both].sum() / 2.0, turned[both & np.isfinite(theta)].sum()
    with np.errstate(divide="ignore", invalid="ignore"):
        travel, turn = (by_pose / by_wheels).tolist()
    return [
        *scale_note(travel, "x_m and y_m", "m", "the wheels' travel"),
        *scale_note(turn, "theta_rad", "rad", "the wheels' turn"),
    ]


def fastest(measurement: Measurement) -> tuple[float, float]:
    """Return the highest speed of a wheel over the floor [m/s] and the highest yaw rate [rad/s] over half a second.

    Both are those of nominal wheels by the counts; 0 where nothing was counted.
    """
    if not isinstance(measurement.nominal, NominalDrive):
        raise TypeError(f"{measurement.name} is no drive")
    robot = measurement.nominal.robot
    per_tick = 2.0 * np.pi * robot.wheel_radius_m.value / robot.encoder_ticks_per_revolution
    speed_m_s = turn_rad_s = 0.0
    for trial in measurement.trials:
        lasts_s = trial.t_s[HALF_SECOND_ROWS:] - trial.t_s[:-HALF_SECOND_ROWS]
        left, right = (per_tick * _net(trial, f"enc_{side}_ticks") / lasts_s for side in ("left", "right"))
        both = np.isfinite(left + right)
        if both.any():
            speed_m_s = max(speed_m_s, float(np.abs([left, right])[:, both].max()))
            turn_rad_s = max(turn_rad_s, float(np.abs(right - left)[both].max()) / robot.wheel_separation_m.value)
    return speed_m_s, turn_rad_s


def _net(trial: Trial, name: str) -> Array:
    """Return the changes over each half second, where noise is small beside the motion; NaN if an end is missing."""
    values = trial[name].values
    return values[HALF_SECOND_ROWS:] - values[:-HALF_SECOND_ROWS]


IMPORTER = case_importer(CaseKind.DRIVE_LOG, NominalDrive, _noise, _notes)
