"""Line channels from the pose: closed forms on a straight tape, and the tolerances that are no discovery."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.measured.nominal import LogNoise, NominalLog
from diagnosis.predictors.line_readings import LineReadings
from diagnosis.predictors.unit_spread import UnitSpread
from sensors.effects.line_adc_saturation import LineAdcSaturation
from sensors.effects.line_ambient import LineAmbient
from sensors.effects.line_crosstalk import LineCrosstalk
from sensors.effects.line_gain import LineGain
from sensors.effects.line_height import LineHeight
from sensors.effects.line_lateral_offset import LineLateralOffset
from sensors.effects.line_offset import LineOffset
from symolo.core.time_series import TimeSeries

ROWS = 40
FLOOR, TAPE, WIDTH_M = 0.85, 0.05, 0.015
NOISE = LogNoise(d_m=0.002, line=0.004, pose_xy_m=0.001, pose_theta_rad=0.0, v_m_s=0.0, w_rad_s=0.0)
SPOT_SD_M = 0.25 * (0.002 + 0.003)
"""A disc of 2 mm that grows by 1 mm per mm of height, at 3 mm: its diameter over 4."""
PLACES_M = 0.009525 * (np.arange(8) - 3.5)


@pytest.fixture(scope="module")
def robot():
    """A robot without tolerances of its line sensor."""
    nominal = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    return nominal.with_section("line_sensor", {"gain_sd": 0.0, "offset_sd": 0.0, "period_s": 1e-9})


@pytest.fixture(scope="module")
def stage(robot):
    """A drive along the x axis, on which the tape lies, from 30 mm beside it to 30 mm on the other side."""
    line = {"pieces": [{"kind": "straight", "start": (-5.0, 0.0), "end": (5.0, 0.0)}]}
    arena = ArenaConfig.model_validate({"name": "test", "line": line})
    t_s = 0.05 * np.arange(ROWS)
    columns = {"x_m": 0.1 * t_s, "y_m": SIDEWAYS_M, "theta_rad": np.zeros(ROWS)}
    columns |= {f"line_{k}": np.full(ROWS, 0.5) for k in range(8)}
    channels = [Channel.logged(TimeSeries(k, "", t_s, np.array(v)), Role.READING) for k, v in columns.items()]
    trial = Trial("1", t_s, np.zeros(ROWS, dtype=bool), tuple(channels))
    case = NominalLog(kind="symolo_csv", arena=arena, robot=robot, noise=NOISE)
    source = MeasurementSource("here", ())
    return LineReadings(Measurement("m", CaseKind.SYMOLO_CSV, source, (trial,), case), case, robot)


SIDEWAYS_M = np.linspace(-0.03, 0.03, ROWS)


def ink(spot_sd_m, aside_m=0.0):
    """Share of each spot on the tape, with the noise of the pose, (rows, 8)."""
    sd = math.hypot(spot_sd_m, NOISE.pose_xy_m)
    y = SIDEWAYS_M[:, None] + PLACES_M + aside_m
    return norm.cdf((0.5 * WIDTH_M - y) / sd) - norm.cdf((-0.5 * WIDTH_M - y) / sd)


def light(share, level=1.0):
    return level * (FLOOR + share * (TAPE - FLOOR))


def bare_means(stage, robot):
    return stage._expected([robot])[0][0]


def test_a_channel_reads_the_share_of_its_spot_on_the_tape(stage, robot):
    np.testing.assert_allclose(bare_means(stage, robot), light(ink(SPOT_SD_M)), atol=1e-9)
    assert [observed.channel for observed in stage.observed] == [f"L{k}" for k in range(8)]


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        (LineLateralOffset(offset_m=0.004), light(ink(SPOT_SD_M, 0.004))),
        (LineHeight(height_scale=1.5), light(ink(0.25 * (0.002 + 0.0045)), 1.5**-2)),
        (LineAmbient(offset=0.05), light(ink(SPOT_SD_M)) + 0.05),
        (LineGain(channel="L2", scale=0.8), light(ink(SPOT_SD_M)) * np.where(np.arange(8) == 2, 0.8, 1.0)),
        (LineOffset(channel="L5", offset=-0.03), light(ink(SPOT_SD_M)) - 0.03 * (np.arange(8) == 5)),
        (LineAdcSaturation(low=0.2, high=0.7), np.clip(light(ink(SPOT_SD_M)), 0.2, 0.7)),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_an_effect_changes_the_readings_as_its_definition_says(stage, robot, effect, expected):
    np.testing.assert_allclose(bare_means(stage, robot.with_effect(effect)), expected, atol=1e-9)


def test_crosstalk_takes_a_share_of_each_neighbour(stage, robot):
    bare = bare_means(stage, robot)
    mixed = bare_means(stage, robot.with_effect(LineCrosstalk(share=0.1)))
    np.testing.assert_allclose(mixed[:, 3], 0.8 * bare[:, 3] + 0.1 * (bare[:, 2] + bare[:, 4]))
    np.testing.assert_allclose(mixed[:, 0], 0.9 * bare[:, 0] + 0.1 * bare[:, 1])


def test_the_noise_of_the_pose_is_largest_on_an_edge(stage, robot):
    """By simulation of the noise of the place: a spot whose middle is on one edge of the tape."""
    sd = stage._expected([robot])[1][0]
    share = ink(SPOT_SD_M)
    on_edge = np.unravel_index(np.abs(share - 0.5).argmin(), share.shape)
    y = (
        SIDEWAYS_M[on_edge[0]]
        + PLACES_M[on_edge[1]]
        + NOISE.pose_xy_m * np.random.default_rng(1).standard_normal(40000)
    )
    shares = norm.cdf((0.5 * WIDTH_M - y) / SPOT_SD_M) - norm.cdf((-0.5 * WIDTH_M - y) / SPOT_SD_M)
    assert sd[on_edge] == pytest.approx(0.8 * shares.std(), rel=0.03)
    assert sd[share < 1e-6] == pytest.approx(math.hypot(0.004, 2.0**-10 / math.sqrt(12.0)), rel=1e-2)


class TestUnitSpread:
    N = 30

    @pytest.fixture
    def spread(self):
        rng = np.random.default_rng(3)
        return np.column_stack([5.0 * rng.random(self.N), np.full(self.N, 2.0)])

    @pytest.fixture
    def covariance(self, spread):
        return np.eye(self.N) + spread @ spread.T

    def residuals(self, spread, seed):
        """A draw of the numbers and of the noise."""
        rng = np.random.default_rng(seed)
        return spread @ rng.standard_normal(2) + rng.standard_normal(self.N)

    def test_the_cost_is_that_of_correlated_noise(self, spread, covariance):
        """r' (I + A A')^-1 r is the sum of the squares of the cleaned residuals."""
        residuals, every = self.residuals(spread, 4), np.ones(self.N, dtype=bool)
        cleaned = UnitSpread.of(spread, residuals, every, ~every).without(residuals)
        assert np.sum(cleaned**2) == pytest.approx(residuals @ np.linalg.solve(covariance, residuals))

    @pytest.mark.parametrize("fitted_rows", [0, 1, 20])
    def test_readings_that_are_not_fitted_are_judged_by_their_distribution_given_the_others(
        self, spread, covariance, fitted_rows
    ):
        """The conditional normal distribution, whose covariance has the spread that the fitted rows leave."""
        fitted, residuals = np.arange(self.N) < fitted_rows, self.residuals(spread, 5)
        cleaned = UnitSpread.of(spread, residuals, fitted, ~fitted).without(residuals)
        given, rest = slice(0, fitted_rows), slice(fitted_rows, self.N)
        by_given = covariance[rest, given] @ np.linalg.inv(covariance[given, given])
        off = residuals[rest] - by_given @ residuals[given]
        left = covariance[rest, rest] - by_given @ covariance[given, rest]
        assert np.sum(cleaned[rest] ** 2) == pytest.approx(off @ np.linalg.solve(left, off))
        # The fitted rows are those of a log without the others, so that these cannot tell them anything.
        alone = UnitSpread.of(spread[given], residuals[given], fitted[given], ~fitted[given]).without(residuals[given])
        np.testing.assert_allclose(cleaned[given], alone)

    @pytest.mark.parametrize("fitted_rows", [0, 15, 30])
    def test_cleaned_readings_of_many_units_are_white_noise_fitted_or_not(self, spread, fitted_rows):
        """The standard error of a mean square over 2000 units is the root of 2 / 2000, and of a mean 1 / root 2000."""
        fitted = np.arange(self.N) < fitted_rows
        units = np.stack([self.residuals(spread, seed) for seed in range(2000)])
        cleaned = UnitSpread.of(spread, np.zeros(self.N), fitted, ~fitted).without(units)
        covariance = cleaned.T @ cleaned / len(units)
        np.testing.assert_allclose(np.diag(covariance), 1.0, atol=5.0 * math.sqrt(2.0 / 2000))
        np.testing.assert_allclose(covariance - np.diag(np.diag(covariance)), 0.0, atol=5.0 / math.sqrt(2000))

    @pytest.mark.parametrize("fitted_rows", [0, 30])
    def test_wild_readings_determine_nothing(self, spread, fitted_rows):
        fitted = np.arange(self.N) < fitted_rows
        noise = 0.1 * np.random.default_rng(6).standard_normal(self.N)
        residuals = spread @ [1.5, -2.0] + noise
        residuals[::7] += 100.0
        cleaned = UnitSpread.of(spread, residuals, fitted, ~fitted).without(residuals)
        tame = np.arange(self.N) % 7 != 0
        # The likelihood chooses the best numbers, and these would cost 1.5^2 + 2^2.
        assert np.sum(cleaned[tame] ** 2) < 1.5**2 + 2.0**2 + np.sum(noise**2)
        assert cleaned[~tame].min() > 90.0

    def test_a_wild_reading_is_as_uncertain_as_the_others_leave_it(self, spread):
        """sqrt(1 + a P a') with P the inverse of I + A'A of the other rows."""
        residuals = 0.1 * np.random.default_rng(7).standard_normal(self.N)
        residuals[3] = 100.0
        every = np.ones(self.N, dtype=bool)
        others = np.arange(self.N) != 3
        cleaned = UnitSpread.of(spread, residuals, every, ~every).without(residuals)
        posterior = np.linalg.inv(np.eye(2) + spread[others].T @ spread[others])
        mean = posterior @ spread[others].T @ residuals[others]
        sd = math.sqrt(1.0 + spread[3] @ posterior @ spread[3])
        assert cleaned[3] == pytest.approx((100.0 - spread[3] @ mean) / sd)
