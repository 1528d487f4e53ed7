"""Readings that the three stages of a drive are compared with, and their noise.

The stages are those of the format: wheel speeds from voltages, pose increments from ticks, ranges from poses. Each is
driven by the readings of the one before.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S as DT_S
from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.robot import SENSORS, Robot
from benchmarks.diagnosis.other_robots.drives.room import mounted, wall_distance
from benchmarks.diagnosis.other_robots.drives.table import POSES, RANGES, WHEELS
from benchmarks.diagnosis.other_robots.range_noise import ROUNDING_M2

WINDOW = 10
"""Rows of a pose increment."""


@dataclass
class Measured:
    """Readings, their standard deviations and a mask of the good ones."""

    target: Array
    sigma: Array
    mask: Array


def windows(log: Log, q: int) -> Array:
    """Return the first rows of the windows of a trial."""
    return np.arange(log.starts[q], log.ends[q] - WINDOW, WINDOW)


def increments(log: Log, pose: Array, q: int) -> Array:
    """Return the increments over the windows of a trial, in the frames of their first rows."""
    first = windows(log, q)
    d = pose[first + WINDOW] - pose[first]
    c, s = np.cos(pose[first, 2]), np.sin(pose[first, 2])
    return np.concatenate([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1], d[:, 2]])


def sensor_distance(bot: Robot, pose: Array, sensor: str, extra_yaw: float) -> Array:
    """Return the distances from some poses along the axis of a sensor."""
    mount = bot.ranges.mounts[sensor]
    return wall_distance(bot.room, *mounted(mount, pose), pose[:, 2] + mount[2] + extra_yaw)[0]


def _wheels(bot: Robot, log: Log, q: int, sd: float) -> list[Measured]:
    """Return the wheel speeds of a trial."""
    parts, rows = [], log.rows(q)
    for c in range(2):
        speed = 2 * np.pi * np.diff(log.ticks[c, rows]) / bot.encoder.ticks / DT_S
        good = log.good_ticks[c, rows]
        parts.append(Measured(speed, np.full(len(speed), sd), good[1:] & good[:-1]))
    return parts


def _increments(bot: Robot, log: Log, q: int) -> Measured:
    """Return the pose increments of a trial."""
    k = windows(log, q)
    ticks = sum(np.abs(log.ticks[c, k + WINDOW] - log.ticks[c, k]) for c in range(2)) / 2
    distance = ticks * 2 * np.pi / bot.encoder.ticks * bot.radius
    spread = (bot.travel * bot.factors["travel"]) ** 2 * distance
    edge = bot.tick_length
    xy = np.sqrt(edge**2 / 12 + 2 * bot.pose_xy**2 + (0.12 * bot.pose_theta) ** 2 + spread / 2)
    turn = np.sqrt((edge / bot.track) ** 2 / 3 + 2 * bot.pose_theta**2 + 2 * spread / bot.track**2)
    good = log.good_pose[k] & log.good_pose[k + WINDOW]
    return Measured(increments(log, log.pose, q), np.concatenate([xy, xy, turn]), np.tile(good, 3))


def _ranges(bot: Robot, log: Log, s: int, q: int) -> Measured:
    """Return the ranges of a sensor in a trial, without those at corners and beyond the reach."""
    rows = log.rows(q)
    pose = np.nan_to_num(log.pose[rows], nan=0.3)  # the mask leaves these rows out
    d, up, down = (np.minimum(sensor_distance(bot, pose, SENSORS[s], yaw), 1e3) for yaw in (0, 0.05, -0.05))
    slope = np.abs(up - down) / 0.1
    jump = np.abs(up + down - 2 * d) > 0.03 * d + 0.01
    variance = (
        (bot.factors["tof"] * bot.ranges.noise(d)) ** 2
        + bot.pose_xy**2 * (1 + slope**2 / np.maximum(d, 0.05) ** 2)
        + (bot.pose_theta * slope) ** 2
        + ROUNDING_M2
    )
    good = log.good_ranges[s, rows] & log.good_pose[rows] & np.isfinite(log.ranges[s, rows])
    smooth = ~jump & (d < bot.ranges.reach - 0.03) & (slope < 3)
    return Measured(log.ranges[s, rows], np.sqrt(variance), good & smooth)


def measure(bot: Robot, log: Log, stages: str, trials: list[int], wheel_sd: float) -> Measured:
    """Return the readings of some stages and trials, zero where they are not good."""
    parts: list[Measured] = []
    for q in trials:
        if WHEELS in stages:
            parts += _wheels(bot, log, q, wheel_sd)
        if POSES in stages:
            parts.append(_increments(bot, log, q))
    if RANGES in stages:
        parts += [_ranges(bot, log, s, q) for s in range(len(SENSORS)) for q in trials]
    mask = np.concatenate([part.mask for part in parts])
    target = np.nan_to_num(np.concatenate([part.target for part in parts]))
    return Measured(np.where(mask, target, 0), np.concatenate([part.sigma for part in parts]), mask)
