"""Speeds v and w -> changes of the pose over ten rows, as from encoder ticks."""

from collections.abc import Sequence
from math import pi

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalLog
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.pose.by_counts import WINDOW, Pose
from diagnosis.predictors.rows import bridged, good_values
from physics.robot.floor_place import FloorPlace
from physics.robot.model import RobotModel, applied
from physics.robot.stack import stacked
from symolo.core.arrays import Array

OVER_FLOOR = frozenset({Slot.TRAVEL, Slot.GROUND, Slot.TURNING, Slot.CREEP})
OF_POSE = frozenset({Slot.POSE_POINT, Slot.POSE_HEADING, Slot.POSE_DELAY})


class PoseByWheelSpeeds(Pose):
    """Speeds that the robot computed from its encoder counts. It used the nominal wheels, so that the turns of the
    wheels follow from the speeds.

    A wrong number of counts per turn has the same effect as wheels of another size. Both are reported as the latter.
    """

    parts = ("drive", "encoder")
    slots = frozenset({Slot.GEOMETRY, *OVER_FLOOR, *OF_POSE})
    channels = ("v", "w", "w")

    def _counts(self, measurement: Measurement, nominal: RobotConfig) -> Array:
        forward_m, turn_rad = np.cumsum(self._travel(measurement), axis=0).T
        rim_m = np.stack([forward_m + sign * turn_rad * 0.5 * nominal.drive.track_m for sign in (1, -1)], axis=-1)
        self._per_count = 2.0 * pi / nominal.encoder.counts_per_revolution
        counts = rim_m / (0.5 * nominal.drive.wheel_diameter_m * self._per_count)
        return np.where(np.isfinite(_speeds(measurement)).all(axis=-1, keepdims=True), counts, np.nan)

    def _travel(self, measurement: Measurement) -> Array:
        """Return distance forward [m] and turn [rad] since the row before, (n, 2); 0 in the first row of a trial."""
        speeds = bridged(_speeds(measurement), self._t_s, self._trials)
        travel = np.zeros_like(speeds)
        travel[1:] = self._mean_since_row_before(speeds) * np.diff(self._t_s)[:, None]
        travel[np.cumsum([0, *self._trials[:-1]])] = 0.0
        return travel

    def _mean_since_row_before(self, speeds: Array) -> Array:
        """Return the mean speeds between rows, (n - 1, 2), from those of the rows, (n, 2)."""
        # A speed by encoder counts is their change since the row before, and so the mean speed over this time.
        return speeds[1:]

    def _age_s(self, robots: Sequence[RobotConfig]) -> float | Array:
        return stacked(robots, axes=1).encoder.delay_s

    def _turned(self, model: RobotModel, place: FloorPlace) -> Array:
        turned = self._per_count * self._counted
        return turned * applied(model.functions(Slot.TRAVEL), np.ones_like(turned), place)

    def _added_variance(self, measurement: Measurement) -> tuple[float | Array, float | Array]:
        if not isinstance(measurement.nominal, NominalLog):
            return 0.0, 0.0
        row_s = (self._t_s[self._last] - self._t_s[self._first]) / WINDOW
        noise = measurement.nominal.noise
        return WINDOW * (row_s * noise.v_m_s) ** 2, WINDOW * (row_s * noise.w_rad_s) ** 2


class PoseByBodySpeeds(PoseByWheelSpeeds):
    """Speeds of the body itself, which say nothing of the wheels."""

    has_wheels = False
    parts = ("encoder",)
    slots = OF_POSE

    def _age_s(self, robots: Sequence[RobotConfig]) -> float | Array:
        # They come from no encoder: only the deviation of a hypothesis from the nominal robot is an age.
        return super()._age_s(robots) - self._encoder_delay_s

    def _counts(self, measurement: Measurement, nominal: RobotConfig) -> Array:
        self._encoder_delay_s = nominal.encoder.delay_s
        self._bodily = self._travel(measurement)
        return super()._counts(measurement, nominal)

    def _mean_since_row_before(self, speeds: Array) -> Array:
        # A speed of the body is that at the time of its row (trapezoidal rule).
        return 0.5 * (speeds[1:] + speeds[:-1])

    def _steps(self, model: RobotModel, turned: Array, place: FloorPlace) -> Array:
        del model, turned, place
        return self._bodily


def _speeds(measurement: Measurement) -> Array:
    """Return v [m/s] and w [rad/s] in all rows, (n, 2); NaN where missing."""
    return np.stack([good_values(measurement, name) for name in ("v_m_s", "w_rad_s")], axis=-1)
