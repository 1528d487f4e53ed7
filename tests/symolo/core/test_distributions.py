"""Draws against the closed forms of their distributions, at 5 standard errors of 40,000 draws."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from symolo.core.distributions import Choice, Distribution, LogUniform, Normal, Uniform
from symolo.core.random_streams import stream

DRAWS = 40_000


def draws(distribution: Distribution) -> np.ndarray:
    rng = stream(1, "test")
    return np.array([distribution.draw(rng) for _ in range(DRAWS)])


@pytest.mark.parametrize(
    ("distribution", "cdf"),
    [
        (Uniform(-2.0, 3.0), stats.uniform(-2, 5).cdf),
        (LogUniform(0.01, 100.0), stats.loguniform(0.01, 100).cdf),
        (Normal(5.0, 2.0, low=2.0, high=6.0), stats.truncnorm(-1.5, 0.5, 5, 2).cdf),
        (Normal(0.0, 1.0, low=2.0), stats.truncnorm(2, 4, 0, 1).cdf),
        (Normal(5.0, 2.0), stats.truncnorm(-4, 4, 5, 2).cdf),
    ],
)
def test_draws_follow_the_closed_form(distribution: Distribution, cdf: Callable[[np.ndarray], np.ndarray]):
    """Kolmogorov's distance is below 1.95 / sqrt(n) in 99.9 % of samples."""
    values = np.sort(draws(distribution))
    ranks = np.arange(1, DRAWS + 1) / DRAWS
    distance = np.max(np.abs(cdf(values) - ranks))
    assert distance < 1.95 / math.sqrt(DRAWS)


def test_normal_has_its_mean_and_sd():
    values = draws(Normal(5.0, 2.0))
    assert abs(values.mean() - 5.0) < 5 * 2.0 / math.sqrt(DRAWS)
    assert abs(values.std() - 2.0) < 5 * 2.0 / math.sqrt(2 * DRAWS)


def test_each_option_and_each_whole_number_comes_equally_often():
    rng = stream(1, "test")
    options = [Choice(("a", "b", "c")).draw(rng) for _ in range(DRAWS)]
    whole = [Uniform(3, 5).draw_integer(rng) for _ in range(DRAWS)]
    spread = 5 * math.sqrt(DRAWS * (1 / 3) * (2 / 3))
    for values, members in ((options, "abc"), (whole, (3, 4, 5))):
        counts = [values.count(member) for member in members]
        assert sum(counts) == DRAWS
        assert all(abs(count - DRAWS / 3) < spread for count in counts)


def test_a_normal_without_spread_is_its_mean():
    assert Normal(3.0, 0.0).draw(stream(1)) == 3.0


def test_a_normal_without_limits_ends_at_four_sd():
    assert Normal(1.0, 0.5).extremes() == (-1.0, 3.0)
    assert Normal(1.0, 0.5, high=1.2).extremes() == (-1.0, 1.2)


numbers = st.floats(-1e6, 1e6)


@given(st.lists(numbers, min_size=2, max_size=2).map(sorted), st.integers(0, 2**32))
def test_no_draw_of_a_uniform_leaves_its_ends(ends: list[float], seed: int):
    value = Uniform(*ends).draw(stream(seed))
    assert ends[0] <= value <= ends[1]


@given(st.lists(st.floats(1e-9, 1e9), min_size=2, max_size=2).map(sorted), st.integers(0, 2**32))
def test_no_draw_of_a_log_uniform_leaves_its_ends(ends: list[float], seed: int):
    value = LogUniform(*ends).draw(stream(seed))
    assert ends[0] <= value <= ends[1]


@given(numbers, st.floats(1e-6, 1e6), st.integers(0, 2**32))
def test_no_draw_of_a_normal_leaves_its_ends(mean: float, sd: float, seed: int):
    normal = Normal(mean, sd)
    low, high = normal.extremes()
    assert low <= normal.draw(stream(seed)) <= high


@pytest.mark.parametrize("distribution", [Uniform(0, 1), Normal(0, 1), LogUniform(1, 2), Choice((1, 2))])
def test_a_draw_takes_one_number_from_its_stream(distribution: Distribution):
    """So that the kind of a distribution changes nothing that is drawn after it from the same generator."""
    rng, other = stream(4), stream(4)
    distribution.draw(rng)
    other.random()
    assert rng.random() == other.random()
