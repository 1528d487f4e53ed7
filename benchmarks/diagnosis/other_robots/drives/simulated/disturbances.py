"""Outliers and empty cells of a drive."""

from typing import Any

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S
from benchmarks.diagnosis.other_robots.draws import Array, bad_rows, log_uniform, lost_share, outlier_share, pick
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.robot import SENSORS, Robot


def _size(rng: np.random.Generator) -> float:
    """Return an error of 6 to 60 standard deviations with either sign."""
    return float(pick(rng, [-1, 1])) * log_uniform(rng, 6, 60)


def _disturb_poses(rng: np.random.Generator, bot: Robot, log: Log, share: float) -> None:
    """Add outliers to some coordinates of some poses."""
    bad = bad_rows(rng, len(log.t), share)
    for k in np.flatnonzero(bad):
        coordinates = int(rng.integers(1, 8))
        for c in range(3):
            if coordinates >> c & 1:
                log.pose[k, c] += _size(rng) * (bot.encoder.pose_xy if c < 2 else bot.encoder.pose_theta)
    log.good_pose &= ~bad


def _disturb_ranges(rng: np.random.Generator, bot: Robot, log: Log, share: float) -> None:
    """Add outliers to ranges, in some cases to those of all sensors together."""
    together = rng.random() < 0.3
    same = bad_rows(rng, len(log.t), share)
    for s in range(len(SENSORS)):
        bad = same if together else bad_rows(rng, len(log.t), share)
        for k in np.flatnonzero(bad & np.isfinite(log.ranges[s])):
            sd = float(bot.ranges.noise(log.ranges[s, k]))
            value = round(log.ranges[s, k] + _size(rng) * sd, 3)
            log.ranges[s, k] = float(np.clip(value, 0.0, bot.ranges.reach))
        log.good_ranges[s] &= ~bad


def _disturb_ticks(rng: np.random.Generator, bot: Robot, log: Log, share: float) -> None:
    """Add outliers to the tick counts."""
    for c in range(2):
        bad = bad_rows(rng, len(log.t), min(share, 0.01), 2)
        bad[log.starts] = False
        for k in np.flatnonzero(bad):
            log.ticks[c, k] += round(_size(rng) * bot.wheel_sd * WHEEL_DT_S * bot.encoder.ticks / (2 * np.pi))
        log.good_ticks[c] &= ~bad


def _lose(rng: np.random.Generator, log: Log, share: float) -> None:
    """Empty some poses and ranges."""
    lost: Array = bad_rows(rng, len(log.t), share, 15)
    lost[log.starts] = False
    log.pose[lost] = np.nan
    log.good_pose &= ~lost
    for s in range(len(SENSORS)):
        gone = bad_rows(rng, len(log.t), share)
        log.ranges[s, gone] = np.nan
        log.good_ranges[s] &= ~gone


def disturb(rng: np.random.Generator, bot: Robot, log: Log) -> dict[str, Any]:
    """Add outliers and empty cells to a log, mark what is good, and return what was done."""
    n = len(log.t)
    log.good_pose, log.good_ticks = np.ones(n, bool), np.ones((2, n), bool)
    log.good_ranges = np.isfinite(log.ranges)
    share = outlier_share(rng, 0.003, 0.06)
    channels = {
        "pose": (_disturb_poses, rng.random() < 0.7),
        "tof": (_disturb_ranges, rng.random() < 0.8),
        "ticks": (_disturb_ticks, rng.random() < 0.25),
    }
    for act, chosen in channels.values():
        if chosen:
            act(rng, bot, log, share)
    lost = lost_share(rng, 0.05)
    _lose(rng, log, lost)
    outliers_in = [name for name, (_, chosen) in channels.items() if chosen]
    return {"outlier_share": share, "outliers_in": outliers_in, "dropout_share": lost}
