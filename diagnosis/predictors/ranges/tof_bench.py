"""Distance, target and environment -> reading of a range sensor on its bench.

The nominal sensor of the case format has an offset and a scale only, without the paper's Eq. 24 and without a cone.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalTof
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted
from diagnosis.predictors.rows import good_values, joined, observed_channel, session_time_s
from physics.robot.stack import stackable_groups, stacked, stacked_effects
from sensors.ranging.range_effects import RangeEffects
from sensors.ranging.range_view import RangeView
from sensors.ranging.tof import NOISE_AT_NEAR_MM, noise_sd_m
from symolo.core.arrays import Array

UNKNOWN_REFLECTANCE = 1.0
"""Reflectance of a material that the case does not list."""


class TofBenchStage:
    """All rows of a bench at once."""

    name = "tof"
    at_once = 48

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        trials = measurement.trials
        known = measurement.nominal.tof.reflectance if isinstance(measurement.nominal, NominalTof) else {}
        materials = [name for trial in trials for name in _materials(trial)]
        distance_m, incidence_rad, temperature_C, ambient_lux = (
            good_values(measurement, name) for name in ("distance_m", "incidence_rad", "temperature_C", "ambient_lux")
        )
        self._distance_m = distance_m
        # What was not logged is assumed to be as during the calibration of the sensor.
        self._incidence_rad, self._temperature_C, self._ambient_lux = (
            np.where(np.isfinite(values), values, neutral)
            for values, neutral in (
                (incidence_rad, 0.0),
                (temperature_C, nominal.tof.reference_temperature_C),
                (ambient_lux, 0.0),
            )
        )
        # Angles that are all positive are sizes without a direction, which a direction of tilt cannot be seen in.
        is_signed = bool((self._incidence_rad < 0.0).any())
        self._tilt_rad = self._incidence_rad if is_signed else np.zeros_like(self._incidence_rad)
        self._since_on_s = session_time_s(measurement)
        self._materials = np.array(materials)
        self._reflectance = np.array([known.get(name, UNKNOWN_REFLECTANCE) for name in materials])
        self._bare_sd_m = _noise_sd_m(measurement, self._distance_m)
        names = tuple(dict.fromkeys((*known, *sorted(set(materials)))))
        previous_m = joined(np.concatenate([[np.nan], trial["distance_m"].values[:-1]]) for trial in trials)
        self._previous_distance_m = np.where(np.isfinite(previous_m), previous_m, distance_m)
        covariates = (
            Covariate("distance_m", self._distance_m),
            Covariate(
                "material", np.array([float(names.index(m)) for m in materials]), CovariateShape.CATEGORY, labels=names
            ),
            Covariate("incidence_rad", incidence_rad),
            Covariate("temperature_C", temperature_C),
            Covariate("ambient_lux", ambient_lux),
            Covariate("t_s", self._since_on_s),
            Covariate("row", np.arange(1.0, len(materials) + 1.0)),
            Covariate("previous_distance_m", previous_m, beside="distance_m"),
            # What a sensor remembers of the last reading is in proportion to the step since then.
            Covariate("distance_step_m", self._distance_m - previous_m),
        )
        # A row without an input that other rows have may or may not show its effect.
        logged = [x for x in (incidence_rad, temperature_C, ambient_lux) if np.isfinite(x).any()]
        predictable = np.isfinite(distance_m) & np.all([np.isfinite(x) for x in logged], axis=0)
        offered = tuple(covariate for covariate in covariates if np.isfinite(covariate.values).any())
        reading = observed_channel(measurement, "reading_m", predictable, offered)
        sd = self._expected([nominal])[1][0]
        known_sd = np.where(np.isfinite(distance_m), sd, reading.sd)
        reading = replace(reading, sd=known_sd, resolution=nominal.tof.quantisation_m, is_series=False)
        self.observed: tuple[Observed, ...] = (reading,)

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return (Predicted(*self._expected(robots)),)

    def _expected(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        """Return mean and standard deviation, (M, n) each."""
        mean, sd = (np.empty((len(robots), len(self._distance_m))) for _ in range(2))
        for group in stackable_groups(robots):
            several = [robots[k] for k in group]
            tof = stacked(several, axes=1).tof
            view = RangeView(
                distance_m=self._distance_m,
                previous_distance_m=self._previous_distance_m,
                incidence_rad=self._incidence_rad,
                # A bench does not log the axis of its tilts, so either may be the one.
                tilt_forward_rad=self._tilt_rad,
                tilt_sideways_rad=self._tilt_rad,
                reflectance=self._reflectance,
                material_share={name: (self._materials == name).astype(float) for name in set(self._materials)},
                temperature_C=self._temperature_C,
                reference_temperature_C=tof.reference_temperature_C,
                ambient_lux=self._ambient_lux,
                time_s=self._since_on_s,
            )
            # The sensor on the bench is none of the three on the robot.
            effects = RangeEffects.from_effects(stacked_effects(several, axes=1).without("tof_range_offset"))
            mean[group], sd[group] = effects.expected(
                self._distance_m, self._bare_sd_m * tof.noise_scale, view, tof.quantisation_m
            )
        return mean, sd


def _materials(trial: Trial) -> tuple[str, ...]:
    known = [label.values for label in trial.labels if label.name == "material"]
    return known[0] if known else ("",) * len(trial.t_s)


def _noise_sd_m(measurement: Measurement, distance_m: Array) -> Array:
    """Return the noise (n,) that the case or the channel states, or that of the paper's Eq. 23."""
    if isinstance(measurement.nominal, NominalTof):
        return measurement.nominal.noise.sd_m(distance_m)
    by_paper_m = noise_sd_m(np.full(len(distance_m), 1e-3 * NOISE_AT_NEAR_MM), distance_m)
    stated = measurement.across("reading_m")
    begin = np.cumsum([0, *(len(channel.values) for channel in stated)])
    for channel, first in zip(stated, begin.tolist(), strict=False):
        if channel.noise_sd is not None:
            by_paper_m[first : first + len(channel.values)] = channel.noise_sd
    return by_paper_m
