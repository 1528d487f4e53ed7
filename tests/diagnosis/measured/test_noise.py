"""Noise estimators against noise whose parameters are known: white, AR(1), with signal, steps, outliers and gaps."""

import math

import numpy as np
import pytest

from diagnosis.measured.noise import (
    noise_of_differences,
    noise_of_repeats,
    trimmed_variance,
)


def rng(seed):
    return np.random.Generator(np.random.PCG64(seed))


def ar1(seed, rows, sd, correlation):
    """Noise of this standard deviation; the first sample is of it too, so that nothing has to settle."""
    fresh = rng(seed).standard_normal(rows)
    values = np.empty(rows)
    values[0] = fresh[0]
    for i in range(1, rows):
        values[i] = correlation * values[i - 1] + math.sqrt(1 - correlation**2) * fresh[i]
    return sd * values


def test_a_trimmed_variance_of_normal_deviates_is_their_variance():
    assert trimmed_variance(3.0 * rng(1).standard_normal(200_000)) == pytest.approx(9.0, rel=0.02)


def test_a_trimmed_variance_of_few_is_that_of_what_is_kept():
    """Of 1, 1, 1, 1, 100 the four small ones are kept: their mean square is 1, of a normal deviate 0.4377."""
    bound = 1.2815515655446004
    expected = 1 - 2 * bound * math.exp(-(bound**2) / 2) / math.sqrt(2 * math.pi) / 0.8
    assert trimmed_variance(np.array([1.0, -1.0, 100.0, 1.0, 1.0])) == pytest.approx(1 / expected)


@pytest.mark.parametrize(
    ("correlation", "within"),
    [(-0.4, 0.06), (0.0, 0.06), (0.3, 0.06), (0.6, 0.15)],  # slow noise is hard to distinguish from a slow signal
)
def test_standard_deviation_and_correlation_of_known_noise(correlation, within):
    noise = noise_of_differences(ar1(7, 20_000, 0.1, correlation))
    assert noise.sd == pytest.approx(0.1, rel=within)
    assert noise.correlation == pytest.approx(correlation, abs=within)


def test_the_standard_errors_are_of_the_size_of_the_errors():
    """Over 40 logs of 2000 rows the estimates scatter as their standard errors say, within a third."""
    noises = [noise_of_differences(ar1(seed, 2000, 0.1, 0.3)) for seed in range(40)]
    for name, error in (("sd", "sd_error"), ("correlation", "correlation_error")):
        scatter = np.std([getattr(noise, name) for noise in noises], ddof=1)
        assert np.mean([getattr(noise, error) for noise in noises]) == pytest.approx(scatter, rel=0.35)


def test_a_smooth_signal_is_no_noise():
    t = np.arange(4000) * 0.005
    noise = noise_of_differences(2.0 * np.sin(2.0 * t) + 5.0 * t + ar1(3, 4000, 0.02, 0.3))
    assert noise.sd == pytest.approx(0.02, rel=0.1)
    assert noise.correlation == pytest.approx(0.3, abs=0.1)


def test_steps_outliers_and_dropouts_hardly_count():
    values = ar1(5, 6000, 0.1, 0.3) + np.repeat([0.0, 8.0, -3.0], 2000)
    values[::60] += 5.0
    values[7::90] = np.nan
    noise = noise_of_differences(values)
    assert noise.sd == pytest.approx(0.1, rel=0.15)
    assert noise.correlation == pytest.approx(0.3, abs=0.1)


def test_differences_do_not_reach_across_a_gap():
    """Pieces of six rows, each on a line of its own: four in ten second differences would reach across."""
    values = np.arange(60.0) + np.repeat(rng(2).uniform(-50, 50, 10), 6)
    joined = np.diff(np.arange(60) // 6) == 0
    assert noise_of_differences(values, joined).sd == pytest.approx(0.0, abs=1e-9)
    assert noise_of_differences(values).sd > 1.0


def test_repeats_show_the_noise_whatever_lies_between_the_conditions():
    conditions = [k // 3 for k in range(3000)]
    means = rng(4).uniform(-100, 100, 1000)
    noise = noise_of_repeats(means[conditions] + 0.04 * rng(5).standard_normal(3000), conditions)
    assert noise.rows == 2000
    assert noise.sd == pytest.approx(0.04, rel=0.05)


def test_a_pair_counts_as_its_difference_over_the_root_of_two():
    values = np.array([0.0, 0.2] * 10)
    noise = noise_of_repeats(values, [k // 2 for k in range(20)])
    kept = trimmed_variance(np.full(10, 0.2 / math.sqrt(2)))
    assert noise.sd == pytest.approx(math.sqrt(kept))


def test_too_little_data_show_no_noise():
    assert noise_of_differences(np.arange(9.0)) is None
    assert noise_of_repeats(np.arange(10.0), list(range(10))) is None


def test_a_channel_that_never_changes_has_no_noise():
    assert noise_of_differences(np.ones(50)).sd == 0.0
