"""Draws against the closed forms of their distributions, at 5 standard errors of 40,000 draws."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from symolo.core.distributions import Choice, Distribution, LogUniform, Normal, Uniform, in_words, parse
from symolo.core.errors import InputError
from symolo.core.random_streams import stream
from symolo.core.yaml.tree import node_of

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
        counts = [sum(value == member for value in values) for member in members]
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


class Fixed:
    """A generator that gives one number."""

    def __init__(self, number: float) -> None:
        self.number = number

    def random(self) -> float:
        return self.number


ALMOST_1 = 1.0 - 2.0**-53


@pytest.mark.parametrize(
    ("distribution", "drawn"),
    [
        (Uniform(2.0, 6.0), {0.0: 2.0, 0.25: 3.0}),
        (LogUniform(1.0, 100.0), {0.0: 1.0, 0.5: 10.0, 0.75: math.sqrt(1000.0)}),
        (Normal(5.0, 2.0), {0.5: 5.0, 0.0: -3.0}),
        (Normal(5.0, 2.0, low=5.0), {0.5: 5.0 + 2.0 * stats.norm.ppf(0.75)}),
        (Normal(0.0, 1.0, low=-50.0), {0.0: -50.0}),
        (Choice(("a", "b", "c", "d")), {0.0: "a", 0.26: "b", 0.75: "d", ALMOST_1: "d"}),
    ],
)
def test_a_draw_is_the_quantile_of_its_uniform_number(distribution: Distribution, drawn: dict):
    for number, value in drawn.items():
        expected = value if isinstance(value, str) else pytest.approx(value, rel=1e-4)
        assert distribution.draw(Fixed(number)) == expected  # type: ignore[arg-type]


def test_whole_numbers_share_the_uniform_numbers_equally_or_are_rounded():
    drawn = [Uniform(3, 5).draw_integer(Fixed(u)) for u in (0.0, 0.33, 0.34, 0.66, 0.67, ALMOST_1)]  # type: ignore[arg-type]
    assert drawn == [3, 3, 4, 4, 5, 5]
    assert [Uniform(-2, 7).draw_integer(Fixed(u)) for u in (0.0, 0.55, ALMOST_1)] == [-2, 3, 7]  # type: ignore[arg-type]
    assert LogUniform(1, 100).draw_integer(Fixed(0.51)) == round(100**0.51)  # type: ignore[arg-type]
    assert Normal(5.2, 1.0).draw_integer(Fixed(0.5)) == 5  # type: ignore[arg-type]


def test_the_share_within_limits_is_that_of_the_gaussian():
    assert Normal(3.0, 2.0, 1.0, 5.0).share_within() == pytest.approx(0.682689, abs=1e-6)
    assert Normal(3.0, 2.0, low=3.0).share_within() == pytest.approx(0.5, abs=1e-4)
    assert Normal(3.0, 0.0, 3.0, 3.0).share_within() == Normal(3.0, 0.0, 2.0, 4.0).share_within() == 1.0
    assert Normal(3.0, 0.0, 3.5, 4.0).share_within() == Normal(3.0, 0.0, 2.0, 2.5).share_within() == 0.0


@pytest.mark.parametrize(
    ("written", "distribution"),
    [
        ({"uniform": [1, 2.5]}, Uniform(1, 2.5)),
        ({"uniform": [2, 2]}, Uniform(2, 2)),
        ({"log_uniform": [1e-9, 1]}, LogUniform(1e-9, 1)),
        ({"normal": [3, 0]}, Normal(3, 0)),
        ({"normal": {"sd": 2, "mean": 3, "high": 7, "low": 1}}, Normal(3, 2, 1, 7)),
        ({"normal": {"mean": 3, "sd": 2}}, Normal(3, 2)),
        ({"normal": {"mean": 3, "sd": 0, "low": 3, "high": 3}}, Normal(3, 0, 3, 3)),
        ({"normal": {"mean": 0, "sd": 1, "low": 3.0}}, Normal(0, 1, low=3.0)),
        ({"choice": [0.5]}, Choice((0.5,))),
        ({"choice": list(range(256))}, Choice(tuple(range(256)))),
    ],
)
def test_a_distribution_is_read_as_written(written: dict, distribution: Distribution):
    assert parse(node_of(written, "test"), ("a",)) == distribution


@pytest.mark.parametrize(
    ("written", "allowed"),
    [
        ({"uniform": [2, 1]}, "the lower end first"),
        ({"log_uniform": [0, 1]}, "ends > 0"),
        ({"log_uniform": [-1, 1]}, "ends > 0"),
        ({"normal": [0, -1]}, "sd >= 0"),
        ({"normal": [1e308, 4e307]}, "4 sd to both sides, is finite"),
        ({"normal": [-1e308, 4e307]}, "4 sd to both sides, is finite"),
        ({"normal": [0, 5e307]}, "4 sd to both sides, is finite"),
        ({"normal": {"mean": 0, "sd": 1, "low": 3.2}}, "at least a thousandth"),
        ({"normal": {"mean": 0, "sd": 1, "low": 2, "high": 1}}, "low below high"),
        ({"normal": {"sd": 1, "low": 2}}, "mean and sd"),
        ({"normal": {"mean": 1, "low": 2}}, "mean and sd"),
        ({"choice": []}, "1 to 256 values"),
        ({"choice": list(range(257))}, "1 to 256 values"),
        ({"choice": [1, None]}, "numbers, names"),
        ({"uniform": [True, 2]}, "2 numbers"),
        ({"uniform": [1, "2"]}, "2 numbers"),
        ({"uniform": [1]}, "2 numbers"),
    ],
)
def test_a_distribution_that_makes_no_sense_is_refused(written: dict, allowed: str):
    with pytest.raises(InputError, match=allowed):
        parse(node_of(written, "test"), ("a",))


def test_a_distribution_cannot_be_changed(changeable):
    for kind in (Uniform, Normal, LogUniform, Choice):
        assert changeable(kind) == []


@pytest.mark.parametrize(("options", "end"), [(8, "7, 8"), (9, "7, 8 and 1 more"), (10, "7, 8 and 2 more")])
def test_a_choice_lists_up_to_eight_options_and_the_number_of_the_others(options: int, end: str):
    assert in_words(Choice(tuple(range(1, options + 1)))) == f"choice of 1, 2, 3, 4, 5, 6, {end}"
