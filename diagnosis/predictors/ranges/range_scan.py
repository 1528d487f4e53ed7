"""Places of a range sensor in front of a round object -> settled readings, for objects whose place is not known.

The object is taken for a ball in front of a board. Its place, distance and radius are fitted again for every robot, so
that a robot is judged by what no ball can explain. An offset of the readings is a nearer or farther ball, a scale is a
flattened one, and neither can be seen; how a reading changes from the middle of the ball outwards can.
"""

from collections.abc import Sequence

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Covariate, Observed, Predicted
from diagnosis.predictors.distinct import distinct
from diagnosis.validation.range_sensor.recordings.ball_fit import Ball, HalfScan, Law, SmoothBeam, fitted_ball
from diagnosis.validation.range_sensor.recordings.scan import ScanRecording
from physics.robot.model import applied
from sensors.ranging.range_view import RangeView
from sensors.ranging.tof import NOISE_AT_NEAR_MM, noise_sd_m
from symolo.core.arrays import Array
from symolo.core.errors import InputError

SLOTS = frozenset({Slot.RAY_WEIGHT, Slot.RANGE})


class RangeScan:
    """The settled reading of each point from the middle of the object to the side where nothing holds it."""

    name = "tof"
    at_once = 48

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        scan, holdout = _scan(measurement)
        half = HalfScan.from_scan(scan)
        if not half.shows_a_ball:
            what = "no near object in front of a far one"
            raise InputError(what, where=measurement.where, cure="scan over a round object with a board far behind it")
        inner = np.flatnonzero(half.inner)
        self._board_m = 1e-3 * half.board_mm
        self._places_mm, readings_mm = half.places_mm[inner], half.reading_mm[inner]
        held = holdout[half.points[inner]]
        self._fitted = ~held
        self._readings_mm = readings_mm
        off_mm = self._ball(nominal).from_middle_mm(self._places_mm)
        rows = np.zeros(len(inner), dtype=np.int64)
        self._sd_m = noise_sd_m(np.full(len(inner), 1e-3 * NOISE_AT_NEAR_MM), 1e-3 * readings_mm)
        observed = Observed(
            name="reading_m",
            channel="reading_m",
            unit="m",
            values=1e-3 * readings_mm,
            sd=self._sd_m,
            correlation=0.0,
            trial=rows,
            t_s=half.points[inner].astype(float),
            holdout=held,
            usable=np.ones(len(inner), dtype=bool),
            # Beam and ball are round, so that the sensor shows along this; along anything else, the object does.
            covariates=(Covariate("from_middle_m", 1e-3 * off_mm),),
            noise_is_stated=False,
            is_series=False,
            samples="points from the middle of the object to one side, each of which has several rows,",
        )
        self.observed: tuple[Observed, ...] = (observed,)

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        several, which = distinct(robots, ("tof",), SLOTS)
        means = [1e-3 * self._ball(robot).readings_mm(self._law(robot), self._places_mm) for robot in several]
        return (Predicted(np.array(means)[which], np.broadcast_to(self._sd_m, (len(robots), len(self._sd_m)))),)

    def _ball(self, robot: RobotConfig) -> Ball:
        return fitted_ball(self._law(robot), self._places_mm[self._fitted], self._readings_mm[self._fitted])

    def _law(self, robot: RobotConfig) -> Law:
        beam, functions = SmoothBeam(robot.tof, robot.effects), robot.effects.functions(Slot.RANGE)

        def law(nearest_m: float, radius_m: float, off_m: Array) -> Array:
            range_m, incidence_rad = beam.seen(nearest_m, radius_m, self._board_m, off_m)
            level = np.zeros_like(off_m)
            view = RangeView(
                distance_m=range_m,
                # The order of the places is not that of a fit, which moves them.
                previous_distance_m=range_m,
                incidence_rad=incidence_rad,
                tilt_forward_rad=level,
                tilt_sideways_rad=level,
                reflectance=np.ones_like(off_m),
                material_share={},
                temperature_C=robot.tof.temperature_C,
                reference_temperature_C=robot.tof.reference_temperature_C,
                ambient_lux=robot.tof.ambient_lux,
                time_s=0.0,
            )
            return applied(functions, range_m, view)

        return law


def _scan(measurement: Measurement) -> tuple[ScanRecording, Mask]:
    """Return the scan, and which of its points are held out, (P,)."""
    (trial,) = measurement.trials
    x_mm, y_mm, reading_mm = (1e3 * trial[name].values for name in ("x_m", "y_m", "reading_m"))
    begins = np.flatnonzero(np.concatenate([[True], (np.diff(x_mm) != 0.0) | (np.diff(y_mm) != 0.0)]))
    scan = ScanRecording(x_mm[begins], y_mm[begins], reading_mm.reshape(len(begins), -1))
    return scan, trial.holdout[begins]
