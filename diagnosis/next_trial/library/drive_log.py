"""Manoeuvres of a drive on a free floor, one after the other, as the nominal robot would log them."""

from collections.abc import Mapping, Sequence
from math import pi

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.importers.drive_log import ROW_S
from diagnosis.measured.case_files.case_format import POSE, RANGE_SIDES
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.measured.room_distances import room_ranges
from diagnosis.next_trial.library.base import Library, Units
from diagnosis.next_trial.library.manoeuvres import Manoeuvre, Reach, manoeuvres, path_of
from diagnosis.next_trial.limits import Limits
from diagnosis.next_trial.template import measurement_of, nominal_drive, trial_with
from diagnosis.predictors.drive_log import TICKS, offers
from diagnosis.predictors.pose.by_counts import Pose
from symolo.core.arrays import Array
from symolo.core.errors import InputError

MARGIN_TRACKS = 1.0
"""Distance of the planned path from the border of the floor, relative to the distance between the wheels."""
MIN_TRACKS = 0.75
"""The same of a path that a robot is expected to drive."""
POSE_OF_MOUNT = ("x_m", "y_m", "yaw_rad")


def drive_log(template: Measurement, limits: Limits, robots: Sequence[RobotConfig]) -> Library:
    """Return the manoeuvres for the limits, each at each place in the sequence.

    All begin and end at the same pose, at rest, so that any sequence of them is a path on the floor. What a manoeuvre
    shows may depend on its time, as with a clock that drifts.

    Raises:
        InputError: No manoeuvre fits the floor and the time.
    """
    del robots
    listed = list(manoeuvres(_reach(template, limits)))
    if not listed:
        cure = "give more room with --floor, or more time for a manoeuvre with --row-seconds"
        raise InputError(f"no manoeuvre of {limits.row_s:g} s fits the floor", got=floor_text(limits), cure=cure)
    slots = limits.units

    def composed(units: Units) -> Measurement:
        return measurement_of(template, [_planned(template, limits, "1", 0, [listed[k] for k in units // slots])])

    every = [
        _planned(template, limits, str(k + 1), k % slots, [listed[k // slots]]) for k in range(len(listed) * slots)
    ]
    return Library(
        measurement_of(template, every),
        np.arange(len(every)) // slots,
        is_unit_a_row=False,
        slots=tuple(np.arange(len(listed)) * slots + slot for slot in range(slots)),
        composed=composed,
        ordered=lambda units: units,
        titles=tuple(listed[k // slots].title for k in range(len(every))),
    )


def start_of(limits: Limits) -> Array:
    """Return the pose (3,) at which the path begins: in the middle of the floor, along its longer side."""
    width_m, depth_m = limits.floor_m
    return np.array([*limits.middle_m, 0.0 if width_m >= depth_m else 0.5 * pi])


def expected_paths(
    trial: Measurement, limits: Limits, nominal: RobotConfig, robots: Sequence[RobotConfig]
) -> Sequence[Array]:
    """Return the poses (n, 3) that each robot reaches with the counts of a planned drive; none without counts."""
    if not offers(trial, TICKS):
        return ()
    stage = Pose(trial, nominal)
    return tuple(stage.path(robot, np.tile(start_of(limits), (len(trial.trials), 1))) for robot in robots)


def beyond_m(template: Measurement, limits: Limits, paths: Sequence[Array]) -> float:
    """Return by how much paths (n, 3) come nearer to the border of the floor than a robot may; 0 if none does."""
    margin_m = MIN_TRACKS * nominal_drive(template).robot.wheel_separation_m.value
    half_m = 0.5 * np.array(limits.floor_m) - margin_m
    return max((float((np.abs(path[:, :2] - limits.middle_m) - half_m).max()) for path in paths), default=0.0)


def floor_text(limits: Limits) -> str:
    """Return the size of the floor in words."""
    return "{:.3g} m x {:.3g} m".format(*limits.floor_m)


def wheel_speeds(nominal: NominalDrive, commands: Array) -> Array:
    """Return the speeds (N, 2) of the left and the right wheel [rad/s] for commands (N, 2), by the nominal wheels."""
    apart_m_s = 0.5 * nominal.robot.wheel_separation_m.value * commands[:, 1]
    return np.stack([commands[:, 0] - apart_m_s, commands[:, 0] + apart_m_s], axis=-1) / (
        nominal.robot.wheel_radius_m.value
    )


def _reach(template: Measurement, limits: Limits) -> Reach:
    track_m = nominal_drive(template).robot.wheel_separation_m.value
    margin_m = MARGIN_TRACKS * track_m + limits.drift_m
    along, across = (0.5 * length_m - margin_m for length_m in sorted(limits.floor_m, reverse=True))
    return Reach(
        rows=round(limits.row_s / ROW_S),
        speed_m_s=limits.max_speed_m_s,
        turn_rad_s=limits.max_turn_rad_s,
        track_m=track_m,
        half_floor_m=(along, across),
    )


def _planned(template: Measurement, limits: Limits, name: str, slot: int, parts: Sequence[Manoeuvre]) -> Trial:
    """Return a trial of some manoeuvres from a place in the sequence, with all that the nominal robot would log."""
    nominal = nominal_drive(template)
    commands = np.concatenate([part.commands for part in parts])
    t_s = np.round(ROW_S * (slot * len(commands) + np.arange(len(commands) + 1)), 6)
    pose = path_of(commands, start_of(limits))
    speeds = wheel_speeds(nominal, commands)
    held = np.concatenate([commands, np.zeros((1, 2))])
    turned = np.concatenate([np.zeros((1, 2)), ROW_S * np.cumsum(speeds, axis=0)])
    per_rad = nominal.robot.encoder_ticks_per_revolution / (2.0 * pi)
    columns = {
        "v_cmd_m_s": held[:, 0],
        "w_cmd_rad_s": held[:, 1],
        "enc_left_ticks": per_rad * turned[:, 0],
        "enc_right_ticks": per_rad * turned[:, 1],
        **dict(zip(POSE, pose.T, strict=True)),
        **_voltages(nominal, speeds),
        **_ranges(nominal, pose),
    }
    logged = {name: values for name, values in columns.items() if any(c.is_offered for c in template.across(name))}
    logged |= {name: columns[name] for name in ("v_cmd_m_s", "w_cmd_rad_s")}
    return trial_with(template, name, t_s, logged)


def _voltages(nominal: NominalDrive, speeds: Array) -> Mapping[str, Array]:
    """Return the voltages (N + 1,) with which the nominal motors reach the speeds (N, 2) from row to row."""
    if (motor := nominal.motor) is None:
        return {}
    drag_N_m = motor.viscous_friction_N_m_s_rad.value * speeds + motor.coulomb_friction_N_m.value * np.sign(speeds)
    risen = np.diff(speeds, axis=0, prepend=np.zeros((1, 2))) / ROW_S
    torque_N_m = drag_N_m + motor.rotor_inertia_kg_m2.value * risen
    constant = motor.torque_constant_N_m_A.value
    volts = constant * speeds + motor.winding_resistance_ohm.value / constant * torque_N_m
    volts = np.clip(volts, -motor.supply_voltage_V, motor.supply_voltage_V)
    volts = np.concatenate([volts, np.zeros((1, 2))])
    return {"u_left_V": volts[:, 0], "u_right_V": volts[:, 1]}


def _ranges(nominal: NominalDrive, pose: Array) -> Mapping[str, Array]:
    """Return the ranges (N + 1,) of the sensors that the robot has, NaN without a target."""
    if nominal.tof is None or nominal.world is None:
        return {}
    mounts = {side: mount for side in RANGE_SIDES if (mount := getattr(nominal.tof.mount, side)) is not None}
    if not mounts:
        return {}
    x_m, y_m, yaw_rad = (np.array([getattr(mount, key) for mount in mounts.values()]) for key in POSE_OF_MOUNT)
    distance_m = room_ranges(nominal.world, pose, x_m, y_m, yaw_rad).distance_m
    distance_m = np.where(distance_m <= nominal.tof.max_range_m, distance_m, np.nan)
    return {f"tof_{side}_m": distance_m[:, k] for k, side in enumerate(mounts)}
