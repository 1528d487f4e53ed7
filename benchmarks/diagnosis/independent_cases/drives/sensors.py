"""What the camera and the range sensors log without noise, from the true path in fine steps of 10 ms."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.diagnosis.independent_cases.drives.robot import SENSORS
from benchmarks.diagnosis.independent_cases.drives.room import cast, sensor_ray
from benchmarks.diagnosis.independent_cases.drives.wheels import FINE_S, SUB
from benchmarks.diagnosis.independent_cases.recipes import Array, Mask, Parameters, Variant

if TYPE_CHECKING:
    from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting

LOOKS = 8  # moments in the gathering time, over which a reading is the mean


def _pose_at(poses: Array, t_s: Array) -> Array:
    """Return true poses (trials, n, 3) at times since the start of a trial, before which the robot stands still."""
    at = np.clip(np.asarray(t_s) / FINE_S, 0, poses.shape[1] - 1)
    whole = np.minimum(at.astype(int), poses.shape[1] - 2)
    part = (at - whole)[None, :, None]
    return poses[:, whole] * (1 - part) + poses[:, whole + 1] * part


def _row_times(poses: Array) -> Array:
    """Return the times (s) of the 20 Hz rows."""
    return np.arange(0, poses.shape[1], SUB) * FINE_S


def logged_pose(variant: Variant, poses: Array, trials: Sequence[int]) -> Array:
    """Return the tracked pose (trials, rows, 3) in m, m, rad without noise."""
    listed, outside = dict(variant.effects), dict(variant.outside)
    delay = listed.get("pose_time_offset", {"delay_s": 0.0})["delay_s"]
    rate = listed.get("pose_clock_drift", {"rate": 0.0})["rate"]
    ahead = listed.get("marker_offset", {"offset_m": 0.0})["offset_m"]
    yaw = np.zeros(len(trials))
    if "marker_yaw" in listed:
        p = listed["marker_yaw"]
        yaw = np.array([p["angle_by_trial_rad"][t] if "angle_by_trial_rad" in p else p["angle_rad"] for t in trials])
    t = _row_times(poses)
    pose = _pose_at(poses, t - delay - rate * t)
    x = pose[..., 0] + ahead * np.cos(pose[..., 2])
    y = pose[..., 1] + ahead * np.sin(pose[..., 2])
    theta = pose[..., 2] + yaw[:, None]
    if "heading_distortion" in outside:
        p = outside["heading_distortion"]
        theta = theta + p["amplitude_rad"] * np.sin(2 * theta + p["phase_rad"])
    return np.stack([x, y, theta], axis=-1)


def _distance(
    poses: Array, times: Sequence[Array], mount: Sequence[float], room: Sequence[float], glass: Parameters | None
) -> Array:
    """Return the mean distance (m) along a ray over the looks at those times (s); one wall may read too far."""
    mean: Array | float = 0.0
    for t in times:
        d, wall = cast(sensor_ray(_pose_at(poses, t), mount), room)
        if glass is not None:
            d = d + glass["extra_m"] * (wall == glass["wall"])
        mean = mean + d / len(times)
    return np.asarray(mean)


def _with_outside(reading: Array, outside: dict[str, Parameters], sensor: str, session_s: Array) -> Array:
    """Return the readings (m) of one sensor with outside effects."""
    if "range_periodic" in outside:
        p = outside["range_periodic"]
        reading = reading + p["amplitude_m"] * np.sin(2 * np.pi * reading / p["wavelength_m"] + p["phase_rad"])
    if "range_memory" in outside and outside["range_memory"]["sensor"] == sensor:
        before = np.concatenate([reading[:, :1], reading[:, :-1]], axis=1)
        reading = reading + outside["range_memory"]["share"] * (before - reading)
    if "range_gain_drift" in outside:
        p = outside["range_gain_drift"]
        reading = reading * (1 + p["change"] * session_s / p["span_s"])
    return reading


def ranges(setting: "DriveSetting", variant: Variant, poses: Array, trials: Sequence[int]) -> tuple[Array, Mask]:
    """Return readings (m) without noise and whether they are beyond reach, both (trials, rows, 3 sensors)."""
    robot, listed, outside = setting.robot, dict(variant.effects), dict(variant.outside)
    t = _row_times(poses) - listed.get("tof_time_offset", {"delay_s": 0.0})["delay_s"]
    duration = listed.get("range_gathering_time", {"duration_s": 0.0})["duration_s"]
    times = [t - look for look in (np.arange(LOOKS) + 0.5) / LOOKS * duration] if duration else [t]
    offset = listed.get("tof_range_offset", {"sensor": "", "offset_m": 0.0})
    turned = listed.get("tof_mount_yaw", {"sensor": "", "angle_rad": 0.0})
    scale = listed.get("tof_range_scale", {"scale": 1.0})["scale"]
    common = variant.individual(setting.individual, robot.all_nominal)["range_offset"]
    readings = []
    for sensor in SENSORS:
        x, y, yaw = robot.mounts[sensor]
        mount = (x, y, yaw + (turned["angle_rad"] if turned["sensor"] == sensor else 0.0))
        reading = scale * _distance(poses, times, mount, robot.room, outside.get("glass_wall"))
        reading = reading + common + (offset["offset_m"] if offset["sensor"] == sensor else 0.0)
        readings.append(_with_outside(reading, outside, sensor, setting.session_s[list(trials)]))
    reading = np.stack(readings, axis=-1)
    return reading, reading > robot.max_range_m
