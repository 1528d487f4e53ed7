"""Distributions, which may stand in a scenario instead of a number, and from which each run draws.

Every draw takes exactly one uniform number from its generator, and every distribution has finite ends, so that a
bound of the schema holds for all of its draws once it holds for its ends.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from statistics import NormalDist

import numpy as np

from symolo.core.errors import InputError, nearest
from symolo.core.yaml.tree import DISTRIBUTION_KINDS, FieldPath, Node, Scalar, dotted

_WITHOUT_LIMITS_SD = 4.0
_MIN_SHARE = 1e-3
_MAX_OPTIONS = 256  # each is held against the schema
_NORMAL_KEYS = ("mean", "sd", "low", "high")
_EXAMPLES = {
    "uniform": "{uniform: [low, high]}",
    "normal": "{normal: [mean, sd]}",
    "log_uniform": "{log_uniform: [low, high]}",
    "choice": "{choice: [a, b]}",
}
_NORMAL_EXAMPLE = "{normal: {mean: m, sd: s, low: a, high: b}}"


@dataclass(frozen=True)
class Uniform:
    """Every number between the ends is as likely; of a whole-number field, every whole number from low to high."""

    low: float
    high: float

    def extremes(self) -> tuple[float, ...]:
        return (self.low, self.high)

    def draw(self, rng: np.random.Generator) -> float:
        return min(self.low + (self.high - self.low) * rng.random(), self.high)

    def draw_integer(self, rng: np.random.Generator) -> int:
        return int(self.low) + math.floor((self.high - self.low + 1) * rng.random())


@dataclass(frozen=True)
class Normal:
    """Gaussian, cut off at `low` and `high`, or at 4 sd from the mean where they are not given."""

    mean: float
    sd: float
    low: float | None = None
    high: float | None = None

    def extremes(self) -> tuple[float, ...]:
        low = self.mean - _WITHOUT_LIMITS_SD * self.sd if self.low is None else self.low
        high = self.mean + _WITHOUT_LIMITS_SD * self.sd if self.high is None else self.high
        return (low, high)

    def share_within(self) -> float:
        """Return the probability that the Gaussian without limits falls between them."""
        if self.sd == 0:
            return float(self.extremes()[0] <= self.mean <= self.extremes()[1])
        below, up_to = (NormalDist(self.mean, self.sd).cdf(end) for end in self.extremes())
        return up_to - below

    def draw(self, rng: np.random.Generator) -> float:
        uniform = rng.random()
        if self.sd == 0:
            return self.mean
        low, high = self.extremes()
        gaussian = NormalDist(self.mean, self.sd)
        probability = gaussian.cdf(low) + self.share_within() * uniform
        return min(max(gaussian.inv_cdf(probability), low), high) if probability > 0 else low

    def draw_integer(self, rng: np.random.Generator) -> int:
        return round(self.draw(rng))


@dataclass(frozen=True)
class LogUniform:
    """The logarithm is uniform: as likely between 1 and 10 as between 10 and 100."""

    low: float
    high: float

    def extremes(self) -> tuple[float, ...]:
        return (self.low, self.high)

    def draw(self, rng: np.random.Generator) -> float:
        exponent = math.log(self.low) + (math.log(self.high) - math.log(self.low)) * rng.random()
        return min(max(math.exp(exponent), self.low), self.high)

    def draw_integer(self, rng: np.random.Generator) -> int:
        return round(self.draw(rng))


@dataclass(frozen=True)
class Choice:
    """Each option is as likely; options are numbers, names, or true and false."""

    options: tuple[Scalar, ...]

    def extremes(self) -> tuple[Scalar, ...]:
        return self.options

    def draw(self, rng: np.random.Generator) -> Scalar:
        return self.options[math.floor(len(self.options) * rng.random())]


Distribution = Uniform | Normal | LogUniform | Choice


def in_words(distribution: Distribution | None) -> str:
    """Return a distribution in the words of a scenario; empty for None."""
    match distribution:
        case Uniform(low, high):
            return f"uniform {low:g} to {high:g}"
        case LogUniform(low, high):
            return f"log-uniform {low:g} to {high:g}"
        case Normal(mean, sd, low, high):
            minimum, maximum = distribution.extremes()
            cut = "" if low is None and high is None else f", cut at {minimum:g} and {maximum:g}"
            return f"normal {mean:g}, sd {sd:g}{cut}"
        case Choice(options):
            names = ", ".join(str(option) for option in options[:8])
            return f"choice of {names}" + (f" and {len(options) - 8} more" if len(options) > 8 else "")
        case None:
            return ""


def parse(node: Node, path: FieldPath) -> Distribution:
    """Read a distribution.

    Raises:
        InputError: Unknown kind, wrong number of arguments, ends in the wrong order.
    """
    what = dotted(path)
    entries = dict(node.children())
    kind, arguments = next(iter(entries.items()), ("", node))
    if len(entries) != 1 or kind not in DISTRIBUTION_KINDS:
        unknown = [key for key in entries if key not in DISTRIBUTION_KINDS]
        raise InputError(
            what,
            where=node.where,
            got=node.plain(),
            allowed="a single value, or one of " + ", ".join(_EXAMPLES.values()),
            nearest=nearest(unknown[0], DISTRIBUTION_KINDS) if unknown else "",
        )
    example = _NORMAL_EXAMPLE if kind == "normal" and isinstance(arguments.value, dict) else _EXAMPLES[str(kind)]
    faulty = partial(
        InputError, f"{what}.{kind}", where=arguments.where, got=arguments.plain(), cure=f"write {example}"
    )
    if kind == "choice":
        return _parse_choice(arguments, faulty)
    if kind == "normal":
        return _parse_normal(arguments, faulty)
    low, high = _numbers(arguments.value, 2, faulty)
    if low > high:
        raise faulty(allowed="the lower end first")
    if kind == "uniform":
        return Uniform(low, high)
    if low <= 0:
        raise faulty(allowed="ends > 0")
    return LogUniform(low, high)


def _parse_choice(arguments: Node, faulty: Callable[..., InputError]) -> Choice:
    items = arguments.value
    if not isinstance(items, tuple) or not 1 <= len(items) <= _MAX_OPTIONS:
        raise faulty(allowed=f"a list of 1 to {_MAX_OPTIONS} values")
    if any(isinstance(item.value, dict | tuple) or item.value is None for item in items):
        raise faulty(allowed="numbers, names, or true and false")
    return Choice(tuple(item.value for item in items))  # type: ignore[misc]


def _parse_normal(arguments: Node, faulty: Callable[..., InputError]) -> Normal:
    if isinstance(arguments.value, dict):
        entries = arguments.value
        unknown = [key for key in entries if key not in _NORMAL_KEYS]
        if unknown:
            raise faulty(allowed="the keys mean, sd, low, high", nearest=nearest(unknown[0], _NORMAL_KEYS))
        if "mean" not in entries or "sd" not in entries:
            raise faulty(allowed="mean and sd, and low and high where wanted")
        numbers = dict(zip(entries, _numbers(tuple(entries.values()), len(entries), faulty), strict=True))
        normal = Normal(numbers["mean"], numbers["sd"], numbers.get("low"), numbers.get("high"))
    else:
        mean, sd = _numbers(arguments.value, 2, faulty)
        normal = Normal(mean, sd)
    low, high = normal.extremes()
    if normal.sd < 0:
        raise faulty(allowed="sd >= 0")
    if not (math.isfinite(low) and math.isfinite(high)):
        raise faulty(allowed="mean and sd whose range, 4 sd to both sides, is finite")
    if low > high:
        raise faulty(allowed="low below high")
    if normal.share_within() < _MIN_SHARE:
        raise faulty(allowed="low and high that hold at least a thousandth of the draws")
    return normal


def _numbers(items: object, count: int, faulty: Callable[..., InputError]) -> tuple[float, ...]:
    values = [item.value for item in items if isinstance(item, Node)] if isinstance(items, tuple) else []
    numbers = tuple(value for value in values if isinstance(value, int | float) and not isinstance(value, bool))
    if not len(numbers) == len(values) == count:
        raise faulty(allowed=f"{count} numbers")
    return numbers
