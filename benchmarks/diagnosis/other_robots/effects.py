"""Effects of a kind: the ranges of their parameters, and draws from these."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array, log_uniform, pick, significant

Key = tuple[str, str | None]
"""The name of an effect and its discrete parameter."""
Ratios = dict[str, float]


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect with its plausible range."""

    name: str
    low: float
    high: float
    log: bool = False
    """Whether the logarithm of a shape parameter is uniform."""


@dataclass(frozen=True)
class Effect:
    """The parameters of an effect, the first being its size."""

    parameters: tuple[Parameter, ...]
    discrete: tuple[str, tuple[str, ...]] | None = None
    """Name and values of a discrete parameter."""
    scale: bool = False
    """Whether the size is a factor about 1, which grows in its logarithm."""
    threshold: bool = False
    """Whether the size is a level (a limit or a saturation), which is drawn and not made to grow."""

    def variants(self) -> Sequence[str | None]:
        """Return the values of the discrete parameter, or None alone."""
        return self.discrete[1] if self.discrete else (None,)


Table = dict[str, Effect]


def sized(name: str, low: float, high: float, *shapes: Parameter) -> Effect:
    """Return an effect whose size is between low and high, with further parameters."""
    return Effect((Parameter(name, low, high), *shapes))


def factor(low: float, high: float, name: str = "scale") -> Effect:
    """Return an effect that multiplies something."""
    return Effect((Parameter(name, low, high),), scale=True)


def level(name: str, low: float, high: float, *shapes: Parameter) -> Effect:
    """Return an effect that acts beyond a level."""
    return Effect((Parameter(name, low, high), *shapes), threshold=True)


def label(key: Key) -> str:
    """Return the name with the discrete parameter in brackets."""
    return key[0] if key[1] is None else f"{key[0]}[{key[1]}]"


def draw_shapes(rng: np.random.Generator, effect: Effect) -> list[float]:
    """Return plausible values of all parameters but the size."""
    values = []
    for p in effect.parameters[1:]:
        value = log_uniform(rng, p.low, p.high) if p.log else rng.uniform(p.low, p.high)
        values.append(float(max(1, round(value))) if p.name == "cycles_per_turn" else significant(value))
    return values


def first_size(rng: np.random.Generator, effect: Effect) -> float:
    """Return a first guess of the size, small beside its range, with a random sign where both exist."""
    p = effect.parameters[0]
    if effect.threshold:
        return significant(rng.uniform(p.low, p.high))
    if effect.scale:
        grows = rng.random() < 0.5
        return 1 + 0.2 * (p.high - 1) if grows else 1 - 0.2 * (1 - p.low)
    if p.low < 0:
        return 0.1 * float(pick(rng, [p.low, p.high]))
    return p.low + 0.1 * (p.high - p.low)


def scaled(effect: Effect, size: float, by: float) -> float:
    """Return the size made larger by a factor, within its range."""
    p = effect.parameters[0]
    grown = float(np.exp(np.clip(np.log(size) * by, -3, 3))) if effect.scale else size * by
    return float(np.clip(grown, p.low, p.high))


def columns(table: Table, keys: list[Key], thetas: Array, first: int) -> list[tuple[Key, list[Array]]]:
    """Return each effect with the columns of its parameters, which begin behind the nominal parameters."""
    split = []
    for key in keys:
        last = first + len(table[key[0]].parameters)
        split.append((key, [thetas[:, k] for k in range(first, last)]))
        first = last
    return split
