"""Voltages -> wheel speeds and pose increments of a whole drive, open loop from rest, as its log would have them.

The pose follows from the voltages alone, as in a simulation, and not from the ticks that were measured, as in the stage
`pose`: an error of the motors shows in it. Increments over ten rows are asked for, not places: of an open loop those
say where an error began, for ever after.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.engine.base import Driven, Driver, without_body
from diagnosis.importers.drive_log import ROW_S
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import NominalDrive
from diagnosis.predictors.base import Observed, Predicted
from diagnosis.predictors.drive_log import POSE
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.pose import STRIDE, WINDOW, Pose, earlier, seen_from_body
from diagnosis.predictors.rows import given, joined, rows_after
from diagnosis.predictors.wheels import Wheels
from physics.robot.model import through
from physics.robot.stack import stacked_effects
from symolo.core.arrays import Array


@dataclass(frozen=True)
class DrivenPath:
    """One trial, from its start on, by voltages alone; poses are x [m], y [m], yaw [rad]."""

    t_s: Array
    """(n,)."""
    measured: Array
    """(n, 3), NaN where the camera saw nothing."""
    nominal: Array
    """(n, 3), of the nominal robot."""
    extended: Array
    """(n, 3), of the extended robot."""

    def off_m(self, path: Array) -> Array:
        """(n,), how far a path is from the measured place."""
        return np.hypot(*(path - self.measured)[:, :2].T)


class EngineDrive:
    """Trials with held-out rows, by one driver; the others are not driven."""

    name = "drive"
    at_once = 2

    def __init__(self, measurement: Measurement, nominal: RobotConfig, driver: Driver) -> None:
        self._is_case = isinstance(measurement.nominal, NominalDrive)
        self._driver = driver
        self._grid = Grid.of(measurement, 1.0 / ROW_S if self._is_case else None)
        held = [self._grid.held(measurement.trials, f"u_{side}_V")[:-1] for side in ("right", "left")]
        self._voltage_V = np.stack(held, axis=-1)
        self._wanted = [bool(trial.holdout.any()) for trial in measurement.trials]
        self._counts = nominal.encoder.counts_per_revolution
        self._next = rows_after(measurement, 1)
        self._windows = rows_after(measurement, WINDOW, STRIDE)
        numbers = np.concatenate(self._grid.places)
        self._lasts_s = self._grid.period_s * (numbers[self._next[1]] - numbers[self._next[0]])
        self._t_s = joined(trial.t_s for trial in measurement.trials)
        self._rows = [len(trial.t_s) for trial in measurement.trials]
        self._measured = np.stack([given(measurement, name) for name in POSE], axis=-1)
        self._known: dict[str, Array] = {}
        self.observed: tuple[Observed, ...] = (
            *Wheels(measurement, nominal).observed,
            *Pose(measurement, nominal).observed,
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        each = [self._predicted(robot) for robot in robots]
        return tuple(
            Predicted(np.stack([of[k] for of in each]), observed.sd) for k, observed in enumerate(self.observed)
        )

    def _predicted(self, robot: RobotConfig) -> tuple[Array, ...]:
        """Of each observed quantity, (n,)."""
        rows = self._sampled(robot)
        angle_rad = 2.0 * pi / self._counts * rows[:2]
        first, after = self._next
        speeds = []
        for wheel in (1, 0):
            speed = np.full(rows.shape[1], np.nan)
            speed[first] = (angle_rad[wheel, after] - angle_rad[wheel, first]) / self._lasts_s
            speeds.append(speed)
        path, seen = rows[2:].T, self._logged(robot, rows[2:].T)
        first, last = self._windows
        increments = seen_from_body(path[first, 2], seen[last] - seen[first])
        return (*speeds, *increments.T)

    def path(self, nominal: RobotConfig, extended: RobotConfig) -> "DrivenPath":
        """The first trial with held-out rows, from its first measured pose on."""
        trial = self._wanted.index(True)
        begin = sum(self._rows[:trial])
        of = slice(begin, begin + self._rows[trial])
        measured = self._measured[of]
        known = np.flatnonzero(np.isfinite(measured).all(axis=1))[0]
        paths = []
        for robot in (nominal, extended):
            seen = self._logged(robot, self._sampled(robot)[2:].T)[of]
            turn = measured[known, 2] - seen[known, 2]
            paths.append(measured[known] + seen_from_body(np.full(len(seen), -turn), seen - seen[known]))
        return DrivenPath(self._t_s[of], measured, paths[0], paths[1])

    def _sampled(self, robot: RobotConfig) -> Array:
        """(5, n), counts right and left and pose in the rows of all trials; each robot is driven once."""
        key = robot.model_dump_json()
        if key not in self._known:
            samples = np.full((len(self._voltage_V) + 1, 5, len(self._rows)), np.nan)
            for k, wanted in enumerate(self._wanted):
                if wanted:
                    samples[..., k] = self._driven(robot, k)
            self._known[key] = self._grid.of_rows(samples)
        return self._known[key]

    def _driven(self, robot: RobotConfig, trial: int) -> Array:
        """(T + 1, 5), counts right and left, pose; NaN after the trial's last row."""
        rows = int(self._grid.places[trial][-1])
        found: Driven = self._driver(
            without_body(robot) if self._is_case else robot, self._voltage_V[:rows, trial], self._grid.period_s
        )
        samples = np.full((len(self._voltage_V) + 1, 5), np.nan)
        samples[: rows + 1] = np.concatenate([found.counts, found.pose], axis=1)
        return samples

    def _logged(self, robot: RobotConfig, pose: Array) -> Array:
        """What the log says of poses (n, 3), by the effects of whoever tracks them."""
        effects = stacked_effects([robot], axes=0)
        pose = earlier(pose, self._t_s, self._rows, through(effects.functions(Slot.POSE_DELAY), 0.0))
        return through(effects.functions(Slot.POSE_POINT), pose)
