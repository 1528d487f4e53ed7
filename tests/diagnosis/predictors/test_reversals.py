"""Relays that switch where a robot starts to turn or to drive the other way."""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors.pose.reversals import body_rates, reversal_covariates, switchings

ROW_S, ROWS = 0.05, 200


@pytest.fixture(scope="module")
def nominal():
    return draw_robot(load_section("robot", "nominal"), 1, "test")[0]


@pytest.fixture
def reversals(nominal):
    """The covariates of windows of ten rows, one at every fifth row, from the places of the rims [m] at each row."""

    def of(right_m, left_m, trials=1):
        m_per_count = np.pi * nominal.drive.wheel_diameter_m / nominal.encoder.counts_per_revolution
        counts = np.floor(np.stack([right_m, left_m], axis=-1) / m_per_count)
        rows = len(counts) // trials
        t_s = ROW_S * np.arange(rows)
        logs = tuple(Trial(str(k), t_s, np.zeros(rows, dtype=bool), ()) for k in range(trials))
        measurement = Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), logs)
        first = np.concatenate([np.arange(k * rows, (k + 1) * rows - 10, 5) for k in range(trials)])
        steps_s = np.full(len(counts), ROW_S)
        rates = body_rates(measurement, counts, steps_s, nominal)
        return reversal_covariates(rates, [rows] * trials, (first, first + 10))

    return of


def rims(nominal, forward_m_s, turn_rad_s):
    """Places of the right and the left rim at each row, by the speeds (n,) since the row before."""
    apart_m_s = 0.5 * nominal.drive.track_m * turn_rad_s
    return np.cumsum(ROW_S * (forward_m_s + apart_m_s)), np.cumsum(ROW_S * (forward_m_s - apart_m_s))


@pytest.mark.parametrize(("threshold", "times"), [(0.0, 19), (0.5, 19), (0.99, 19), (1.01, 0)])
def test_a_relay_switches_once_in_each_half_of_a_wave_that_exceeds_its_threshold(threshold, times):
    """Ten waves: the first half has no other direction before it."""
    wave = np.sin(2.0 * np.pi * (np.arange(1000) + 0.5) / 100.0)
    switched = switchings(wave, threshold)
    rows = np.flatnonzero(switched)
    assert len(rows) == times
    np.testing.assert_array_equal(switched[rows], np.where(np.arange(times) % 2 == 0, -1.0, 1.0))
    if times:
        assert np.all(np.abs(wave[rows]) > threshold)
        assert np.all(wave[rows - 1] * switched[rows] <= threshold)


def test_a_pause_is_no_reversal_and_a_turn_the_other_way_after_it_is_one(nominal, reversals):
    turn = np.zeros(ROWS)
    turn[20:60], turn[80:120], turn[152:190] = 1.0, 1.0, -1.0
    turning, driving = reversals(*rims(nominal, np.full(ROWS, 0.3), turn))
    first = np.arange(0, ROWS - 10, 5)
    expected = -1.0 * ((first < 152) & (first + 10 >= 152))
    np.testing.assert_array_equal(np.sign(turning.values), expected)
    np.testing.assert_array_equal(turning.levels, np.repeat(expected[:, None], turning.levels.shape[1], axis=1))
    assert not driving.values.any()


def test_there_and_back_within_a_window_cancel_each_other(nominal, reversals):
    turn = np.full(ROWS, 1.0)
    turn[101:104] = -1.0
    turning, _ = reversals(*rims(nominal, np.full(ROWS, 0.3), turn))
    first = np.arange(0, ROWS - 10, 5)
    went, came = (((first < row) & (first + 10 >= row)).astype(float) for row in (101, 104))
    assert came[went > 0.0].any()
    np.testing.assert_array_equal(turning.levels[:, 0], came - went)


def test_driving_back_is_a_reversal_of_driving_alone(nominal, reversals):
    forward = np.where(np.arange(ROWS) < 97, 0.3, -0.3)
    turning, driving = reversals(*rims(nominal, forward, np.zeros(ROWS)))
    first = np.arange(0, ROWS - 10, 5)
    np.testing.assert_array_equal(np.sign(driving.values), -1.0 * ((first < 97) & (first + 10 >= 97)))
    assert not turning.values.any()


def test_no_reversal_reaches_from_one_trial_into_the_next(nominal, reversals):
    turn = np.repeat([1.0, -1.0], ROWS)
    turning, _ = reversals(*rims(nominal, np.full(2 * ROWS, 0.3), turn), trials=2)
    assert not turning.values.any()


def test_rounded_counts_of_a_straight_path_switch_no_relay(nominal, reversals):
    """Both wheels turn by 3.7 counts in a row, the left one half a count later."""
    m_per_count = np.pi * nominal.drive.wheel_diameter_m / nominal.encoder.counts_per_revolution
    right_m = 3.7 * m_per_count * np.arange(ROWS)
    turning, _ = reversals(right_m, right_m - 0.5 * m_per_count)
    assert not turning.values.any()
