"""Voltages -> wheel speeds and pose increments of a whole drive, open loop from rest, as they would be logged.

The pose follows from the voltages alone, as in a simulation, and not from the measured ticks as in the stage `pose`, so
errors of the motors show in it. Increments over ten rows are compared instead of places, because in an open loop every
place contains all earlier errors.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.engine.base import ORIGIN, Driver, EngineStage, without_body
from diagnosis.importers.drive_log import ROW_S
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Observed
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.pose.by_counts import STRIDE, WINDOW, Pose, seen_from_body
from diagnosis.predictors.pose.delayed_pose import earlier
from diagnosis.predictors.pose.heading_error import turned_by
from diagnosis.predictors.rows import good_values, joined, rows_after, session_time_s
from diagnosis.predictors.wheels.speeds import Wheels
from physics.robot.model import applied
from physics.robot.stack import stacked_effects
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose


@dataclass(frozen=True)
class DrivenPath:
    """Paths of one trial from its start, by the voltages alone; poses are x [m], y [m], yaw [rad]."""

    t_s: Array
    """(n,), times of the rows."""
    measured: Array
    """(n, 3), measured poses; NaN where the camera did not see the robot."""
    nominal: Array
    """(n, 3), poses of the nominal robot."""
    extended: Array
    """(n, 3), poses of the extended robot."""

    def off_m(self, path: Array) -> Array:
        """Return the distances (n,) of a path from the measured places."""
        return np.hypot(*(path - self.measured)[:, :2].T)


class EngineDrive(EngineStage):
    """Trials with held-out rows, simulated by one driver; the other trials are not simulated."""

    name = "drive"

    def __init__(self, measurement: Measurement, nominal: RobotConfig, driver: Driver) -> None:
        self._is_case = isinstance(measurement.nominal, NominalDrive)
        self._driver = driver
        self._grid = Grid.from_measurement(measurement, 1.0 / ROW_S if self._is_case else None)
        held = [self._grid.zero_order_hold(measurement.trials, f"u_{wheel}_V")[:-1] for wheel in ("right", "left")]
        self._voltage_V = np.stack(held, axis=-1)
        self._has_heldout = [bool(trial.holdout.any()) for trial in measurement.trials]
        self._counts = nominal.encoder.counts_per_revolution
        self._next = rows_after(measurement, 1)
        self._windows = rows_after(measurement, WINDOW, STRIDE)
        numbers = np.concatenate(self._grid.places)
        self._lasts_s = self._grid.period_s * (numbers[self._next[1]] - numbers[self._next[0]])
        self._t_s = joined(trial.t_s for trial in measurement.trials)
        self._since_on_s = session_time_s(measurement)
        self._rows = [len(trial.t_s) for trial in measurement.trials]
        self._measured = np.stack([good_values(measurement, name) for name in POSE], axis=-1)
        self._known: dict[str, Array] = {}
        self.observed: tuple[Observed, ...] = (
            *Wheels(measurement, nominal).observed,
            *Pose(measurement, nominal).observed,
        )

    def _means(self, robot: RobotConfig) -> tuple[Array, ...]:
        rows = self._sampled(robot)
        angle_rad = 2.0 * pi / self._counts * rows[:2]
        first, after = self._next
        speeds = []
        for wheel in (1, 0):
            speed = np.full(rows.shape[1], np.nan)
            speed[first] = (angle_rad[wheel, after] - angle_rad[wheel, first]) / self._lasts_s
            speeds.append(speed)
        logged = self._logged(robot, rows[2:].T)
        first, last = self._windows
        increments = seen_from_body(logged[first, 2], logged[last] - logged[first])
        return (*speeds, *increments.T)

    def path(self, nominal: RobotConfig, extended: RobotConfig) -> "DrivenPath":
        """Return the paths of the first trial with held-out rows, from its first measured pose."""
        trial = self._has_heldout.index(True)
        begin = sum(self._rows[:trial])
        rows = slice(begin, begin + self._rows[trial])
        measured = self._measured[rows]
        known = np.flatnonzero(np.isfinite(measured).all(axis=1))[0]
        paths = []
        for robot in (nominal, extended):
            logged = self._logged(robot, self._sampled(robot)[2:].T)[rows]
            turn = measured[known, 2] - logged[known, 2]
            paths.append(measured[known] + seen_from_body(np.full(len(logged), -turn), logged - logged[known]))
        return DrivenPath(self._t_s[rows], measured, paths[0], paths[1])

    def _sampled(self, robot: RobotConfig) -> Array:
        """Return counts right and left and pose in the rows of all trials, (5, n); each robot is driven once."""
        key = robot.model_dump_json()
        if key not in self._known:
            samples = np.full((len(self._voltage_V) + 1, 5, len(self._rows)), np.nan)
            for k, is_needed in enumerate(self._has_heldout):
                if is_needed:
                    samples[..., k] = self._driven(robot, k)
            self._known[key] = self._grid.of_rows(samples)
        return self._known[key]

    def _driven(self, robot: RobotConfig, trial: int) -> Array:
        """Return counts right and left and pose, (T + 1, 5); NaN after the last row of the trial."""
        rows = int(self._grid.places[trial][-1])
        states = self._driver(
            without_body(robot) if self._is_case else robot,
            self._voltage_V[:rows, trial],
            self._grid.period_s,
            self._start(trial),
        )
        samples = np.full((len(self._voltage_V) + 1, 5), np.nan)
        samples[: rows + 1] = np.concatenate([states.counts, states.pose], axis=1)
        return samples

    def _start(self, trial: int) -> PlanarPose:
        """Return the first logged pose of a trial, since a floor may be another one at another place.

        Where exactly the trial begins is not known: the tracked body may be turned on the robot.
        """
        begin = sum(self._rows[:trial])
        poses = self._measured[begin : begin + self._rows[trial]]
        known = poses[np.isfinite(poses).all(axis=1)]
        x_m, y_m, yaw_rad = known[0].tolist() if len(known) else ORIGIN
        return x_m, y_m, yaw_rad

    def _logged(self, robot: RobotConfig, pose: Array) -> Array:
        """Return poses (n, 3) as they would be logged, with the delay and the tracked point of the camera."""
        effects = stacked_effects([robot], axes=0)
        pose = earlier(pose, self._t_s, self._rows, applied(effects.functions(Slot.POSE_DELAY), 0.0, self._t_s))
        tracked = applied(effects.functions(Slot.POSE_POINT), pose)
        errors = effects.functions(Slot.POSE_HEADING)
        if not errors:
            return tracked
        return turned_by(tracked, applied(errors, np.zeros(len(pose)), pose[:, 2], self._since_on_s))
