"""Line channels from the pose: closed forms on a straight tape, and the tolerances that are no discovery."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.scan import starts
from diagnosis.measured.case_files.nominal import LogNoise, NominalLog
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors.line_readings import LineReadings
from diagnosis.predictors.pose.smoothed_pose import NOISE_SHARE
from diagnosis.predictors.ranges.unit_spread import cleaned
from sensors.effects.line_sensor.line_adc_saturation import LineAdcSaturation
from sensors.effects.line_sensor.line_ambient import LineAmbient
from sensors.effects.line_sensor.line_crosstalk import LineCrosstalk
from sensors.effects.line_sensor.line_gain import LineGain
from sensors.effects.line_sensor.line_height import LineHeight
from sensors.effects.line_sensor.line_lateral_offset import LineLateralOffset
from sensors.effects.line_sensor.line_offset import LineOffset
from symolo.core.tables.time_series import TimeSeries

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
    return stage_of(robot, run("1", np.full((ROWS, 8), 0.5)))


def run(name, readings, *, is_held_out=False):
    t_s = 0.05 * np.arange(ROWS)
    columns = {"x_m": 0.1 * t_s, "y_m": SIDEWAYS_M, "theta_rad": np.zeros(ROWS)}
    columns |= {f"line_{k}": readings[:, k] for k in range(8)}
    channels = [Channel.logged(TimeSeries(k, "", t_s, np.array(v)), Role.READING) for k, v in columns.items()]
    return Trial(name, t_s, np.full(ROWS, is_held_out), tuple(channels))


def stage_of(robot, *runs):
    line = {"pieces": [{"kind": "straight", "start": (-5.0, 0.0), "end": (5.0, 0.0)}]}
    arena = ArenaConfig.model_validate({"name": "test", "line": line})
    case = NominalLog(kind="symolo_csv", arena=arena, robot=robot, noise=NOISE)
    source = MeasurementSource("here", ())
    return LineReadings(Measurement("m", CaseKind.SYMOLO_CSV, source, runs, case), case, robot)


SIDEWAYS_M = np.linspace(-0.03, 0.03, ROWS)


def ink(spot_sd_m, aside_m=0.0):
    """Share of each spot on the tape, with the noise of the smoothed pose, (rows, 8)."""
    sd = math.hypot(spot_sd_m, NOISE_SHARE * NOISE.pose_xy_m)
    y = SIDEWAYS_M[:, None] + PLACES_M + aside_m
    return norm.cdf((0.5 * WIDTH_M - y) / sd) - norm.cdf((-0.5 * WIDTH_M - y) / sd)


def light(share, level=1.0):
    return level * (FLOOR + share * (TAPE - FLOOR))


def bare_means(stage, robot):
    return stage._expected(robot).mean


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


@pytest.mark.parametrize(
    ("period_s", "delay_s", "age_s"),
    [(0.005, 0.0, 0.0), (0.05, 0.0, 0.0), (0.005, 0.012, 0.015), (0.02, 0.0, 0.01), (0.03, 0.01, 0.025)],
)
def test_readings_are_as_old_as_the_last_sample_before_the_row(robot, period_s, delay_s, age_s):
    """A sensor whose period divides the rows samples at each row; of another one the mean age is known."""
    sampled = robot.with_section("line_sensor", {"period_s": period_s, "delay_s": delay_s})
    means = bare_means(stage_of(sampled, run("1", np.full((ROWS, 8), 0.5))), sampled)
    aside_m = -age_s * (SIDEWAYS_M[1] - SIDEWAYS_M[0]) / 0.05
    inner = slice(5, -5)
    np.testing.assert_allclose(means[inner], light(ink(SPOT_SD_M, aside_m))[inner], atol=1e-6)


def test_crosstalk_takes_a_share_of_each_neighbour(stage, robot):
    bare = bare_means(stage, robot)
    mixed = bare_means(stage, robot.with_effect(LineCrosstalk(share=0.1)))
    np.testing.assert_allclose(mixed[:, 3], 0.8 * bare[:, 3] + 0.1 * (bare[:, 2] + bare[:, 4]))
    np.testing.assert_allclose(mixed[:, 0], 0.9 * bare[:, 0] + 0.1 * bare[:, 1])


def test_the_noise_of_the_smoothed_pose_is_largest_on_an_edge(stage, robot):
    """By simulation of the noise of the place: a spot whose middle is on one edge of the tape."""
    sd = stage._expected(robot).sd
    share = ink(SPOT_SD_M)
    on_edge = np.unravel_index(np.abs(share - 0.5).argmin(), share.shape)
    noise = NOISE_SHARE * NOISE.pose_xy_m * np.random.default_rng(1).standard_normal(40000)
    y = SIDEWAYS_M[on_edge[0]] + PLACES_M[on_edge[1]] + noise
    shares = norm.cdf((0.5 * WIDTH_M - y) / SPOT_SD_M) - norm.cdf((-0.5 * WIDTH_M - y) / SPOT_SD_M)
    assert sd[on_edge] == pytest.approx(0.8 * shares.std(), rel=0.03)
    assert sd[share < 1e-6] == pytest.approx(math.hypot(0.004, 2.0**-10 / math.sqrt(12.0)), rel=1e-2)


class TestUnitWithTolerances:
    """A unit whose gains, offsets and floor differ from the nominal ones by about their tolerances."""

    @pytest.fixture
    def usual(self, robot):
        return robot.with_section("line_sensor", {"gain_sd": 0.03, "offset_sd": 0.01})

    def readings(self, seed, aside_m=0.0):
        """Another unit for each seed, on a floor of its own, with noise of place and reading."""
        rng = np.random.default_rng(seed)
        aside = aside_m + NOISE_SHARE * NOISE.pose_xy_m * rng.standard_normal((ROWS, 1))
        y = SIDEWAYS_M[:, None] + PLACES_M + aside
        share = norm.cdf((0.5 * WIDTH_M - y) / SPOT_SD_M) - norm.cdf((-0.5 * WIDTH_M - y) / SPOT_SD_M)
        floor, tape = FLOOR - 0.04, TAPE + 0.03
        gain, offset = 1.0 + 0.03 * rng.standard_normal(8), 0.01 * rng.standard_normal(8)
        return gain * (floor + share * (tape - floor)) + offset + NOISE.line * rng.standard_normal((ROWS, 8))

    def mean_squares(self, stage, robot, rows):
        """Mean squares of the residuals in sigmas over some rows."""
        predicted = stage.predict([robot])
        both = zip(stage.observed, predicted, strict=True)
        return np.nanmean([((o.values - p.mean[0]) / p.sd[0])[rows] ** 2 for o, p in both])

    @pytest.mark.parametrize("is_held_out", [False, True])
    def test_it_is_as_good_as_the_nominal_one_in_a_run_that_is_fitted_or_held_out(self, usual, is_held_out):
        """2 runs of 320 readings, whose mean square has a standard error of sqrt(2 / 640)."""
        runs = [run(str(k), self.readings(k), is_held_out=is_held_out) for k in (1, 2)]
        assert self.mean_squares(stage_of(usual, *runs), usual, slice(None)) == pytest.approx(1.0, abs=0.25)

    def test_it_is_known_on_the_line_of_the_robot_in_question_and_not_on_that_of_the_nominal_one(self, usual):
        stage = stage_of(usual, run("1", self.readings(3, aside_m=0.006)))
        shifted = usual.with_effect(LineLateralOffset(offset_m=0.006))
        assert self.mean_squares(stage, shifted, slice(None)) == pytest.approx(1.0, abs=0.35)
        assert self.mean_squares(stage, usual, slice(None)) > 5.0

    def test_a_reading_at_the_end_of_the_converters_range_says_only_that_the_unit_is_beyond(self, usual):
        """With a light of 0.4 every channel reads 1 on the floor. Otherwise the floor would read 3 tolerances more."""
        stage = stage_of(usual, run("1", np.clip(self.readings(5) + 0.4, 0.0, 1.0)))
        lit = usual.with_effect(LineAmbient(offset=0.4))
        predicted = stage.predict([usual, lit])
        means = np.stack([each.mean[1] for each in predicted], axis=-1)
        np.testing.assert_array_equal(means[ink(SPOT_SD_M) < 1e-9], 1.0)
        nominal, bright = predicted[0].by_tolerances
        assert nominal - bright > 5.0

    def test_the_search_for_a_lower_limit_starts_at_the_least_readings(self, usual):
        stage = stage_of(usual, run("1", np.clip(self.readings(5), 0.3, 1.0)))
        limit = CandidateEffect(LineAdcSaturation)
        low, _ = starts(Evidence([stage]), limit)
        assert limit.coordinates[0].value(low) == pytest.approx(0.3)

    def test_a_reading_at_a_limit_that_a_robot_has_says_only_that_the_unit_is_beyond(self, usual):
        """A converter that reads 0.3 at least reads just that on the tape of 0.08, whatever the offsets are."""
        stage = stage_of(usual, run("1", np.clip(self.readings(5), 0.3, 1.0)))
        limited = usual.with_effect(LineAdcSaturation(low=0.3, high=1.0))
        both = zip(stage.observed, stage.predict([limited]), strict=True)
        off = np.stack([o.values - p.mean[0] for o, p in both], axis=-1)
        np.testing.assert_array_equal(off[ink(SPOT_SD_M) > 0.99], 0.0)
        assert self.mean_squares(stage, limited, slice(None)) < 1.3

    def test_a_reading_beyond_a_limit_speaks_against_the_limit(self, usual):
        """The floor of 0.81 is not read by a converter that ends at 0.5."""
        stage = stage_of(usual, run("1", self.readings(5)))
        limited = usual.with_effect(LineAdcSaturation(low=0.0, high=0.5))
        both = zip(stage.observed, stage.predict([limited]), strict=True)
        off = np.stack([o.values - p.mean[0] for o, p in both], axis=-1)
        np.testing.assert_allclose(off[ink(SPOT_SD_M) < 1e-9], 0.31, atol=0.15)

    def test_a_reading_below_the_limit_shows_a_dark_floor_under_bright_light(self, usual):
        """The floor of 0.81 with light of 0.17 reads 0.98; the nominal floor of 0.85 would be beyond the limit."""
        bright = usual.with_effect(LineAmbient(offset=0.17))
        stage = stage_of(usual, run("1", np.clip(self.readings(6) + 0.17, 0.0, 1.0)))
        assert self.mean_squares(stage, bright, slice(None)) == pytest.approx(1.0, abs=0.35)

    def test_what_looks_like_tolerances_is_counted_as_such(self, usual):
        """Light on all channels is about that of the floor, which is 0.4 / 0.05 tolerances."""
        stage = stage_of(usual, run("1", self.readings(4) + 0.3))
        first, second, *_ = stage.predict([usual, usual.with_effect(LIGHT)])
        assert first.by_tolerances is not None
        nominal, lit = first.by_tolerances
        assert nominal > 20.0 + lit
        assert second.by_tolerances is None


LIGHT = LineAmbient(offset=0.3)


class TestCleaned:
    """Residuals of up to four sigmas beside the best numbers; wild ones have less weight."""

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
        return spread @ rng.standard_normal(2) + np.clip(rng.standard_normal(self.N), -2.5, 2.5)

    def test_the_cost_is_that_of_correlated_noise(self, spread, covariance):
        """r' (I + A A')^-1 r is the sum of the squares of the cleaned residuals."""
        residuals, every = self.residuals(spread, 4), np.ones(self.N, dtype=bool)
        z = cleaned(spread, residuals, every, ~every).z
        assert np.sum(z**2) == pytest.approx(residuals @ np.linalg.solve(covariance, residuals))

    def test_the_cost_is_shared_by_noise_and_numbers(self, spread):
        """|r - A m|^2 + |m|^2 with the m of the least sum."""
        residuals, every = self.residuals(spread, 4), np.ones(self.N, dtype=bool)
        result = cleaned(spread, residuals, every, ~every)
        m = np.linalg.lstsq(np.vstack([spread, np.eye(2)]), np.append(residuals, [0.0, 0.0]), rcond=None)[0]
        np.testing.assert_allclose(result.numbers, m)
        assert np.sum(result.z**2) == pytest.approx(np.sum((residuals - spread @ m) ** 2) + np.sum(m**2))

    @pytest.mark.parametrize("fitted_rows", [0, 1, 20])
    def test_readings_that_are_not_fitted_are_judged_by_their_distribution_given_the_others(
        self, spread, covariance, fitted_rows
    ):
        """The conditional normal distribution, whose covariance has the spread that the fitted rows leave."""
        fitted, residuals = np.arange(self.N) < fitted_rows, self.residuals(spread, 5)
        z = cleaned(spread, residuals, fitted, ~fitted).z
        given, rest = slice(0, fitted_rows), slice(fitted_rows, self.N)
        by_given = covariance[rest, given] @ np.linalg.inv(covariance[given, given])
        off = residuals[rest] - by_given @ residuals[given]
        left = covariance[rest, rest] - by_given @ covariance[given, rest]
        assert np.sum(z[rest] ** 2) == pytest.approx(off @ np.linalg.solve(left, off))
        # The fitted rows are as in a log without the others, which are only predicted.
        alone = cleaned(spread[given], residuals[given], fitted[given], ~fitted[given]).z
        np.testing.assert_allclose(z[given], alone)

    @pytest.mark.parametrize("fitted_rows", [0, pytest.param(15, marks=pytest.mark.long), 30])
    def test_cleaned_readings_of_many_units_are_white_noise_fitted_or_not(self, spread, fitted_rows):
        """Over 2000 units, the standard error of a mean square is the root of 2 / 2000, of a product 1 / root 2000."""
        fitted = np.arange(self.N) < fitted_rows
        units = np.stack([cleaned(spread, self.residuals(spread, k), fitted, ~fitted).z for k in range(2000)])
        covariance = units.T @ units / len(units)
        np.testing.assert_allclose(np.diag(covariance), 1.0, atol=5.0 * math.sqrt(2.0 / 2000))
        np.testing.assert_allclose(covariance - np.diag(np.diag(covariance)), 0.0, atol=5.0 / math.sqrt(2000))

    @pytest.mark.parametrize("fitted_rows", [0, 30])
    def test_wild_readings_determine_next_to_nothing(self, spread, fitted_rows):
        fitted = np.arange(self.N) < fitted_rows
        noise = 0.1 * np.random.default_rng(6).standard_normal(self.N)
        residuals = spread @ [1.5, -2.0] + noise
        residuals[::7] += 100.0
        z = cleaned(spread, residuals, fitted, ~fitted).z
        tame = np.arange(self.N) % 7 != 0
        # The likelihood chooses the best numbers, and these would cost 1.5^2 + 2^2.
        assert np.sum(z[tame] ** 2) < 1.5**2 + 2.0**2 + np.sum(noise**2)
        np.testing.assert_allclose(z[~tame], 100.0, atol=3.0)

    def test_rows_without_a_reading_have_no_residual_and_change_nothing(self, spread):
        residuals = self.residuals(spread, 8)
        there = np.arange(self.N) % 3 != 0
        holes = np.where(there, residuals, np.nan)
        z = cleaned(spread, holes, there, np.zeros(self.N, dtype=bool)).z
        assert (z[~there] == 0.0).all()
        every = np.ones(there.sum(), dtype=bool)
        np.testing.assert_allclose(z[there], cleaned(spread[there], residuals[there], every, ~every).z)
