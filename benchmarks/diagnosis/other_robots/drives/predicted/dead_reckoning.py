"""Camera poses that follow from the ticks."""

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S as DT_S
from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.robot import Robot
from benchmarks.diagnosis.other_robots.drives.simulated.readings import marked, pose_delay
from benchmarks.diagnosis.other_robots.drives.table import SIDES
from benchmarks.diagnosis.other_robots.drives.values import Values
from benchmarks.diagnosis.other_robots.drives.wheels import missed_share

MISSED_TICK_ROUNDS = 6


def _rolled(bot: Robot, ticks: Array, c: int, values: Values) -> Array:
    """Return the angles that a wheel turned between rows, with its eccentricity."""
    moved = 2 * np.pi * np.diff(ticks) / bot.encoder.ticks / values.one("encoder_ticks_scale", 1.0)
    missed = values.all("encoder_missed_ticks", SIDES[c])
    if missed:
        w = moved / DT_S
        for _ in range(MISSED_TICK_ROUNDS):
            w = moved / DT_S / (1 - missed_share(w, missed))
        moved = w * DT_S
    eccentricity = values.all("wheel_eccentricity", SIDES[c])
    if eccentricity:
        amplitude, phase = eccentricity
        angle = np.concatenate([[0.0], np.cumsum(moved)])
        moved = moved + amplitude * np.diff(np.sin(angle + phase))
    return moved


def dead_reckoned(bot: Robot, log: Log, trials: list[int], values: Values, theta: Array) -> Array:
    """Return the camera poses that follow from the ticks, from the first good heading of each trial."""
    pose = np.zeros((len(log.t), 3))
    radius = bot.radius * (1 + theta[5] * bot.loose["r"]) * values.one("wheel_radius_scale", 1.0)
    track = bot.track * (1 + theta[6] * bot.loose["b"]) * values.one("wheelbase_scale", 1.0)
    asymmetry, slip = values.one("wheel_radius_asymmetry"), values.one("turn_slip")
    gradient, direction = values.all("floor_slope") or [0.0, 0.0]
    for q in trials:
        rows, start = log.rows(q), log.starts[q]
        rolled = [_rolled(bot, log.ticks[c, rows], c, values) for c in range(2)]
        left, right = (radius * (1 + (0.5 - c) * asymmetry) * rolled[c] for c in range(2))
        forward, turn = 0.5 * (left + right), (right - left) / track
        turn = turn / (1 + slip * np.abs(forward * turn) / DT_S**2)
        good = np.flatnonzero(log.good_pose[rows])
        heading = np.concatenate([[0.0], np.cumsum(turn)])
        if len(good):
            heading = heading + (log.pose[start + good[0], 2] - values.one("marker_yaw") - heading[good[0]])
        middle = heading[:-1] + 0.5 * turn
        creep = np.abs(forward) * gradient
        moved = slice(start + 1, log.ends[q])
        pose[moved, 0] = np.cumsum(forward * np.cos(middle) + creep * np.cos(direction))
        pose[moved, 1] = np.cumsum(forward * np.sin(middle) + creep * np.sin(direction))
        pose[rows, 2] = heading
    pose = log.delayed(pose, pose_delay(values, log.t))
    marked(values, pose)
    return pose
