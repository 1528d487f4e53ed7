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

    def test_the_cost_is_that_of_correlated_noise(self, spread):
        """r' (I + A A')^-1 r is the sum of the squares of the cleaned residuals."""
        residuals = np.random.default_rng(4).standard_normal(self.N)
        cleaned = UnitSpread.of(spread, residuals, np.ones(self.N, dtype=bool)).without(residuals)
        expected = residuals @ np.linalg.solve(np.eye(self.N) + spread @ spread.T, residuals)
        assert np.sum(cleaned**2) == pytest.approx(expected)

    def test_readings_that_are_not_fitted_are_predicted_from_the_others(self, spread):
        """Conditional mean of a normal distribution."""
        fitted = np.arange(self.N) < 20
        residuals = np.random.default_rng(5).standard_normal(self.N)
        cleaned = UnitSpread.of(spread, residuals, fitted).without(residuals)
        joint = np.eye(self.N) + spread @ spread.T
        expected = joint[20:, :20] @ np.linalg.solve(joint[:20, :20], residuals[:20])
        np.testing.assert_allclose(residuals[20:] - cleaned[20:], expected)

    def test_wild_readings_determine_nothing(self, spread):
        noise = 0.1 * np.random.default_rng(6).standard_normal(self.N)
        residuals = spread @ [1.5, -2.0] + noise
        residuals[::7] += 100.0
        of = UnitSpread.of(spread, residuals, np.ones(self.N, dtype=bool))
        assert not of.rows[::7].any()
        # The likelihood chooses the best numbers, and these would cost 1.5^2 + 2^2.
        assert np.sum(of.without(residuals)[of.rows] ** 2) < 1.5**2 + 2.0**2 + np.sum(noise**2)
