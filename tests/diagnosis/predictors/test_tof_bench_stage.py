"""Predictions of the range bench against the format's definitions."""

import math

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.measured.case_files.nominal import NominalTof
from diagnosis.measured.channel import Channel, Label, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from sensors.effects.range_sensor.ambient_noise import AmbientNoise
from sensors.effects.range_sensor.cover_crosstalk import CoverCrosstalk
from sensors.effects.range_sensor.incidence_bias import IncidenceBias
from sensors.effects.range_sensor.log_range_error import LogRangeError
from sensors.effects.range_sensor.material_bias import MaterialBias
from sensors.effects.range_sensor.material_slope import MaterialSlope
from sensors.effects.range_sensor.near_field_error import NearFieldError
from sensors.effects.range_sensor.noise_scale import NoiseScale
from sensors.effects.range_sensor.range_saturation import RangeSaturation
from sensors.effects.range_sensor.temperature_drift import TemperatureDrift
from sensors.effects.range_sensor.warmup_drift import WarmupDrift
from symolo.core.tables.time_series import TimeSeries

REFLECTANCE = {"wood": 0.45, "black_card": 0.05}
NOMINAL = NominalTof.model_validate(
    {
        "kind": "tof_bench",
        "tof": {
            "range_offset_m": {"value": 0.004, "tolerance": 0.0005},
            "range_scale": {"value": 1.01, "tolerance": 0.002},
            "reference_temperature_C": 20.0,
            "resolution_m": 0.001,
            "reflectance": REFLECTANCE,
        },
        "noise": {"polynomial_mm": [1.4, 4.88, 2.51, 1.15], "polynomial_origin_m": 0.18},
    }
)
D = np.array([0.05, 0.18, 0.4, 1.0, 0.4])
T_S = np.array([0.0, 10.0, 20.0, 30.0, 40.0])
COLUMNS = {
    "distance_m": D,
    "incidence_rad": np.array([0.0, 0.3, 0.6, 0.0, math.nan]),
    "temperature_C": np.array([20.0, 25.0, 30.0, 15.0, 20.0]),
    "ambient_lux": np.array([0.0, 1000.0, 500.0, 4000.0, 100.0]),
    "reading_m": np.array([0.05, 8.19, 0.4, math.nan, 0.4]),
}
MATERIALS = ("wood", "black_card", "wood", "black_card", "black_card")
RHO = np.array([REFLECTANCE[name] for name in MATERIALS])
NOISE_M = 1e-3 * np.array([np.polyval([1.15, 2.51, 4.88, 1.4], max(d - 0.18, 0.0)) for d in D])


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


@pytest.fixture(scope="module")
def stage(robot):
    channels = tuple(
        Channel.logged(
            TimeSeries(name, "", T_S, values),
            Role.READING if name == "reading_m" else Role.INPUT,
            no_target=values > 8.0 if name == "reading_m" else None,
        )
        for name, values in COLUMNS.items()
    )
    trial = Trial("1", T_S, np.zeros(5, dtype=bool), channels, (Label("material", MATERIALS),), begins_s=100.0)
    (bound,) = STAGES[CaseKind.TOF_BENCH](
        Measurement("m", CaseKind.TOF_BENCH, MeasurementSource("here", ()), (trial,), NOMINAL), robot
    )
    return bound


def predicted(stage, robot, *several):
    for effect in several:
        robot = robot.with_effect(effect)
    (predicted,) = stage.predict([robot])
    return predicted.mean[0], predicted.sd[0]


def test_the_nominal_reading_is_offset_and_scale_of_the_distance_alone(stage, robot):
    mean, sd = predicted(stage, robot)
    np.testing.assert_allclose(mean, 0.004 + 1.01 * D, rtol=1e-12)
    np.testing.assert_allclose(sd, np.sqrt(NOISE_M**2 + 1e-6 / 12.0), rtol=1e-12)
    np.testing.assert_allclose(stage.observed[0].sd, sd, rtol=1e-12)


def test_codes_missing_readings_and_rows_without_an_input_are_not_usable(stage):
    (of,) = stage.observed
    assert of.usable.tolist() == [True, False, True, False, False]
    assert np.isnan(of.values).tolist() == [False, True, False, True, True]


@pytest.mark.parametrize(
    ("effect", "change"),
    [
        (LogRangeError(coefficient_m=0.02), 0.02 * np.log(np.maximum(D / 0.18, 1.0))),
        (TemperatureDrift(coefficient_m_per_K=1e-3), 1e-3 * (COLUMNS["temperature_C"] - 20.0)),
        (MaterialBias(material="wood", offset_m=0.01), np.array([0.01, 0.0, 0.01, 0.0, 0.0])),
        (MaterialSlope(material="wood", coefficient=0.1), np.array([-0.005, 0.0, 0.03, 0.0, 0.0])),
        (IncidenceBias(coefficient=0.1), 0.1 * D * np.sin(np.nan_to_num(COLUMNS["incidence_rad"])) ** 2),
        (NearFieldError(amplitude_m=0.02, decay_length_m=0.1), 0.02 * np.exp(-D / 0.1)),
        (WarmupDrift(amplitude_m=0.01, time_constant_s=50.0), 0.01 * np.exp(-(100.0 + T_S) / 50.0)),
    ],
)
def test_what_a_effect_adds_is_the_definition_head_on_where_no_angle_was_noted(stage, robot, effect, change):
    np.testing.assert_allclose(predicted(stage, robot, effect)[0], 0.004 + 1.01 * D + change, rtol=1e-12)


def test_crosstalk_divides_by_the_strength_over_the_reflectance_of_the_case(stage, robot):
    mean, _ = predicted(stage, robot, CoverCrosstalk(strength_per_m2=0.05))
    np.testing.assert_allclose(mean - 0.004, 1.01 * D / (1.0 + 0.05 * D**2 / RHO), rtol=1e-12)


def test_noise_effects_scale_deviation_and_variance(stage, robot):
    _, sd = predicted(stage, robot, NoiseScale(scale=2.0), AmbientNoise(coefficient_per_klux=0.5))
    variance = (2.0 * NOISE_M) ** 2 * (1.0 + 0.5 * COLUMNS["ambient_lux"] / 1000.0)
    np.testing.assert_allclose(sd, np.sqrt(variance + 1e-6 / 12.0), rtol=1e-12)


def test_a_saturated_reading_is_flat_far_beyond_the_limit_and_the_mean_of_a_clipped_normal_deviate_at_it(stage, robot):
    """Half a normal deviate is lost at its own mean: the mean is sd / root(2 pi) lower.

    The standard deviation is that before the limit, because in some devices the noise is added after the limit.
    """
    at = 0.004 + 1.01 * 0.4
    mean, sd = predicted(stage, robot, RangeSaturation(saturation_m=at))
    rounding = 1e-6 / 12.0
    assert mean[3] == pytest.approx(at)
    assert mean[2] == pytest.approx(at - NOISE_M[2] / math.sqrt(2.0 * math.pi), abs=0.1 * NOISE_M[2])
    np.testing.assert_allclose(sd[2:4], np.sqrt(NOISE_M[2:4] ** 2 + rounding))
    np.testing.assert_allclose(mean[:2], 0.004 + 1.01 * D[:2], rtol=1e-9)


def test_many_robots_at_once_are_each_of_them_alone(stage, robot):
    robots = [robot]
    for effect in EFFECTS.classes():
        choices = {name: options[0] if options else "wood" for name, options in effect.options().items()}
        first, second = effect.start(choices), effect.null(choices)
        robots += [robot.with_effect(first), robot.with_effect(second)]
    (together,) = stage.predict(robots)
    for k, one in enumerate(robots):
        (alone,) = stage.predict([one])
        np.testing.assert_allclose(together.mean[k], alone.mean[0], rtol=1e-12)
        np.testing.assert_allclose(together.sd[k], alone.sd[0], rtol=1e-12)


def test_covariates_name_what_a_reading_may_depend_on(stage):
    covariates = {covariate.name: covariate for covariate in stage.observed[0].covariates}
    assert set(covariates) == {
        "distance_m", "material", "incidence_rad", "temperature_C", "ambient_lux", "t_s", "row", "previous_distance_m",
        "distance_step_m",
    }  # fmt: skip
    assert [covariates["material"].labels[int(k)] for k in covariates["material"].values] == list(MATERIALS)
    np.testing.assert_array_equal(covariates["previous_distance_m"].values, [math.nan, *D[:-1]])
    np.testing.assert_array_equal(covariates["distance_step_m"].values, [math.nan, *np.diff(D)])
    np.testing.assert_array_equal(covariates["t_s"].values, 100.0 + T_S)
