"""Predictions of the three stages of a drive (`measured.py`)."""

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S as DT_S
from benchmarks.diagnosis.other_robots.compiled import advance_wheels
from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.predicted.dead_reckoning import dead_reckoned
from benchmarks.diagnosis.other_robots.drives.predicted.measured import increments, measure, sensor_distance
from benchmarks.diagnosis.other_robots.drives.robot import NOMINAL, SENSORS, Robot
from benchmarks.diagnosis.other_robots.drives.simulated.readings import pose_delay
from benchmarks.diagnosis.other_robots.drives.table import POSES, RANGES, SIDES, WHEELS
from benchmarks.diagnosis.other_robots.drives.values import Values
from benchmarks.diagnosis.other_robots.drives.wheels import missed_share, wheel_parameters
from benchmarks.diagnosis.other_robots.effects import Key, Table
from benchmarks.diagnosis.other_robots.fits import Problem

LARGEST = 8.0
"""One residual counts for at most as many standard deviations."""


class Staged:
    """Predictions of some stages for some trials, and the readings that they are compared with."""

    def __init__(self, bot: Robot, log: Log, table: Table, stages: str, trials: list[int], *, wheel_sd: float) -> None:
        self.bot, self.log, self.table, self.stages, self.trials = bot, log, table, stages, trials
        self.measured = measure(bot, log, stages, trials, wheel_sd)
        self.target = self.measured.target
        nominal = np.zeros(NOMINAL)
        self.nominal_track = dead_reckoned(bot, log, trials, Values(table, [], nominal), nominal)
        self.problem = Problem(self.predict, self.whiten, table, NOMINAL, rounds=6)

    def whiten(self, r: Array) -> Array:
        """Return residuals in units of their noise, with a limit."""
        r = np.where(self.measured.mask, np.nan_to_num(r), 0) / self.measured.sigma
        return LARGEST * np.tanh(r / LARGEST)

    def predict(self, keys: list[Key], thetas: Array) -> Array:
        """Return the predictions of all stages, a row per variant."""
        wheels = self._wheel_speeds(keys, thetas) if WHEELS in self.stages else None
        out = []
        for v, theta in enumerate(thetas):
            values = Values(self.table, keys, theta)
            track = dead_reckoned(self.bot, self.log, self.trials, values, theta) if POSES in self.stages else None
            parts = []
            for q in self.trials:
                if wheels is not None:
                    parts += self._ticked(wheels[v, :, self.log.starts[q] : self.log.ends[q] - 1], values)
                if track is not None:
                    parts.append(increments(self.log, track, q))
            if RANGES in self.stages:
                parts += self._ranges(values, theta)
            out.append(np.concatenate(parts))
        return np.array(out)

    def _wheel_speeds(self, keys: list[Key], thetas: Array) -> Array:
        """Return mean wheel speeds between rows from the logged voltages, (variants, 2, rows)."""
        log, n = self.log, len(self.log.t)
        parameters = np.ascontiguousarray(wheel_parameters(self.bot, self.table, keys, thetas))
        angles, zero = np.zeros((len(thetas), 2, n)), np.zeros((2, n))
        speeds = np.zeros_like(angles)
        for q in self.trials:
            first, last = log.starts[q], log.ends[q] - 1
            state = np.zeros((len(thetas), 4))
            advance_wheels(parameters, (log.u, log.session, zero, zero), state, angles, (first, last, first))
            speeds[:, :, first:last] = np.diff(angles[:, :, first:last], axis=2, prepend=0) / DT_S
        return speeds

    @staticmethod
    def _ticked(speeds: Array, values: Values) -> list[Array]:
        """Return the wheel speeds that the encoders show."""
        shown = []
        for w, side in zip(speeds, SIDES, strict=True):
            missed = values.all("encoder_missed_ticks", side)
            counted = w * (1 - missed_share(w, missed)) if missed else w
            shown.append(counted * values.one("encoder_ticks_scale", 1.0))
        return shown

    def _ranges(self, values: Values, theta: Array) -> list[Array]:
        """Return ranges from the measured poses."""
        pose = self._robot_poses(values)
        parts = []
        for name in SENSORS:
            yaw, offset = values.at("tof_mount_yaw", name), values.at("tof_range_offset", name)
            for q in self.trials:
                d = sensor_distance(self.bot, pose[self.log.rows(q)], name, yaw)
                parts.append(d * values.one("tof_range_scale", 1.0) + offset + theta[7] * self.bot.loose["tof"])
        return parts

    def _robot_poses(self, values: Values) -> Array:
        """Return the poses of the robot when the ranges were taken, from the measured ones."""
        log, pose, ahead = self.log, self.log.pose.copy(), values.one("marker_offset")
        pose[:, 2] -= values.one("marker_yaw")
        pose[:, 0] -= ahead * np.cos(pose[:, 2])
        pose[:, 1] -= ahead * np.sin(pose[:, 2])
        ranges_late, poses_late = values.one("tof_time_offset") + 0 * log.t, pose_delay(values, log.t)
        if np.any(ranges_late != poses_late):
            # moved as the wheels turned, because a mean of two measured poses would have less noise
            track = log.delayed(self.nominal_track, poses_late)
            moved = log.delayed(self.nominal_track, ranges_late) - track
            turn = pose[:, 2] - track[:, 2]
            pose[:, 0] += np.cos(turn) * moved[:, 0] - np.sin(turn) * moved[:, 1]
            pose[:, 1] += np.sin(turn) * moved[:, 0] + np.cos(turn) * moved[:, 1]
            pose[:, 2] += moved[:, 2]
        return pose
