"""Camera and range readings of the true poses."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.robot import SENSORS, Robot
from benchmarks.diagnosis.other_robots.drives.room import box_distance, mounted, wall_distance
from benchmarks.diagnosis.other_robots.drives.simulated.plans import Draws
from benchmarks.diagnosis.other_robots.drives.values import Values

MIN_RANGE_M = 0.005


def pose_delay(values: Values, t: Array) -> Array:
    """Return how old the camera poses are."""
    return values.one("pose_time_offset") + values.one("pose_clock_drift") * t


def marked(values: Values, pose: Array) -> None:
    """Turn robot poses into poses of the marker, in place."""
    ahead = values.one("marker_offset")
    pose[:, 0] += ahead * np.cos(pose[:, 2])
    pose[:, 1] += ahead * np.sin(pose[:, 2])
    pose[:, 2] += values.one("marker_yaw")


def _camera(bot: Robot, draws: Draws, values: Values, log: Log) -> Array:
    """Return the poses that the camera measures."""
    seen = log.delayed(log.pose, pose_delay(values, log.t))
    marked(values, seen)
    middle = np.array(bot.room) / 2
    distortion = values.one("camera_distortion")
    if distortion:
        d = seen[:, :2] - middle
        seen[:, :2] = middle + d * (1 + distortion * np.sum(d * d, axis=1))[:, None]
    seen[:, 1] = middle[1] + (seen[:, 1] - middle[1]) * (1 + values.one("camera_stretched"))
    seen[:, :2] += bot.pose_xy * draws.camera[:2].T
    seen[:, 2] += bot.pose_theta * draws.camera[2]
    every = round(values.one("camera_slow"))
    if every:
        index = np.arange(len(seen))
        for a, b in zip(log.starts, log.ends, strict=True):
            index[a:b] = a + (np.arange(b - a) // every) * every
        seen = seen[index]
    return seen


def _distances(bot: Robot, values: Values, pose: Array, name: str) -> tuple[Array, Array]:
    """Return the true distances of a sensor and the angles of incidence."""
    px, py = mounted(bot.ranges.mounts[name], pose)
    angle = pose[:, 2] + (bot.ranges.mounts[name][2] + values.at("tof_mount_yaw", name))
    d, incidence = wall_distance(bot.room, px, py, angle, values.one("wall_askew"))
    box = values.all("box_in_room")
    if box:
        size, corner = box
        x0 = 0.0 if int(corner) % 2 == 0 else bot.room[0] - size
        y0 = 0.0 if int(corner) < 2 else bot.room[1] - size
        d = np.minimum(d, box_distance((x0, y0, x0 + size, y0 + size), px, py, angle))
    return np.where(np.isfinite(d) & (d > 0), d, np.nan), incidence


def _filter(value: Array, share: float, t: Array) -> None:
    """Let each reading keep a share of the one before, trial by trial, in place."""
    for k in range(1, len(value)):
        if t[k] > 0 and np.isfinite(value[k - 1]) and np.isfinite(value[k]):
            value[k] = share * value[k - 1] + (1 - share) * value[k]


def add_readings(bot: Robot, draws: Draws, values: Values, offset: float, log: Log) -> None:
    """Replace the true poses in the log by those that the camera measures, and add the ranges.

    Args:
        bot: The robot.
        draws: Random numbers of the run.
        values: Parameters of the effects.
        offset: Offset of the ranges in tolerances.
        log: A log with true poses.
    """
    old = log.delayed(log.pose, values.one("tof_time_offset") + 0 * log.t)
    log.pose = np.round(_camera(bot, draws, values, log), 4)
    for s, name in enumerate(SENSORS):
        d, incidence = _distances(bot, values, old, name)
        value = d * values.one("tof_range_scale", 1.0) + offset * bot.loose["tof"]
        value = value + values.one("range_at_grazing") * d * incidence**2
        value = value + values.at("tof_range_offset", name)
        share = values.one("ranges_filtered")
        if share:
            _filter(value, share, log.t)
        value = value + bot.factors["tof"] * bot.ranges.noise(np.nan_to_num(d)) * draws.reading[s]
        hidden = (value > bot.ranges.reach) | (d > bot.ranges.reach) | (value < MIN_RANGE_M)
        log.ranges[s] = np.round(np.where(hidden, np.nan, value), 3)
