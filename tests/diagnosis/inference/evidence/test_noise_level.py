import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis.inference.evidence.noise_level import correlation_of_differences, lasting


def ar1(p, rows, seed):
    """Of unit variance."""
    white = np.random.default_rng(seed).standard_normal(rows + 200)
    return lfilter([np.sqrt(1.0 - p**2)], [1.0, -p], white)[200:]


@pytest.mark.parametrize("p", [0.0, 0.3, 0.6])
def test_the_correlation_of_ar1_noise(p):
    found = [lasting(ar1(p, 3000, seed), np.repeat(np.arange(3), 1000)) for seed in range(8)]
    assert np.mean(found) == pytest.approx(p, abs=0.06)


def test_rounding_between_rows_does_not_hide_a_disturbance_that_lasts():
    """Noise of 0.7^k over k rows, and the differences of independent rounding errors, with which neighbours correlate
    by -1/2: the sum of autocorrelations is that of the first alone, for those of differences add up to nothing.
    """
    found = []
    for seed in range(8):
        rounding = np.random.default_rng(100 + seed).standard_normal(4001)
        z = np.sqrt(0.5) * ar1(0.7, 4000, seed) + 0.5 * np.diff(rounding)
        found.append(lasting(z, np.zeros(4000, dtype=int)))
    whole = 1.0 + 2.0 * (0.5 * 0.7 / 0.3 - 0.25)
    assert np.mean(found) == pytest.approx((whole - 1.0) / (whole + 1.0), abs=0.08)


def test_a_slow_misfit_is_no_noise_and_gaps_and_trials_are_no_neighbours():
    slow = 3.0 * np.sin(np.linspace(0.0, 6.0 * np.pi, 2000))
    white = np.random.default_rng(5).standard_normal(2000)
    white[::7] = np.nan
    trial = np.repeat(np.arange(4), 500)
    assert lasting(slow + white, trial) < 0.15


def test_too_few_rows_say_nothing():
    assert lasting(ar1(0.8, 40, 1), np.zeros(40, dtype=int)) == 0.0


@pytest.mark.parametrize("p", [0.0, 0.3, 0.6])
def test_differences_show_the_correlation_beside_a_slow_misfit_and_outliers(p):
    """A misfit of three standard deviations with three waves in 2000 rows; one row in fifty is an outlier."""
    slow = 3.0 * np.sin(np.linspace(0.0, 6.0 * np.pi, 2000))
    found = []
    for seed in range(8):
        z = ar1(p, 2000, seed) + slow
        z[::50] += 20.0
        found.append(correlation_of_differences(z, np.repeat(np.arange(4), 500)))
    correlations, errors, sds = np.array([(each.correlation, each.error, each.sd) for each in found]).T
    assert 0.95 < sds.mean() < 1.15  # two of fifty differences have an outlier, which the trimming does not undo
    assert correlations.mean() == pytest.approx(p, abs=0.03)
    # The standard error of the least squares estimate is sqrt((1 - p^2) / n); trimming makes it up to twice as large.
    assert np.sqrt((1.0 - p**2) / 2000) < np.median(errors) < 4.0 * np.sqrt((1.0 - p**2) / 2000)
    assert np.all(np.abs(correlations - p) < 4.0 * errors + 0.02)


def test_few_differences_have_no_certain_correlation():
    assert correlation_of_differences(ar1(0.8, 100, 1), np.zeros(100, dtype=int)).error == np.inf


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_smooth_misfit_with_hardly_any_noise_is_none(noise):
    """A wave of 100 rows: its differences over two rows have nearly four times the squares, or they are small."""
    wave = np.sin(2.0 * np.pi * np.arange(2000) / 100.0)
    found = correlation_of_differences(wave + noise * ar1(0.0, 2000, 1), np.zeros(2000, dtype=int))
    assert found.correlation > 1.0 or found.sd < 0.1
