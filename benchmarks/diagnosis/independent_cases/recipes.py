"""Effects of a case, and recipes that make them grow from nothing with a size."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Parameters = dict[str, Any]
Toleranced = tuple[float, float]  # a nominal value and its tolerance, both in the unit of the value


class Effect(NamedTuple):
    """One difference between the true robot and the nominal one, listed in the format or not."""

    name: str
    parameters: Parameters


@dataclass(frozen=True)
class Recipe:
    """Parameters of one effect as a function of its size, which is plausible between `low` and `high`.

    Effects of one `place` are not drawn together; "outside" is the place of effects that the format does not list.
    A `fixed` recipe has no size. The size of a `clamped` recipe is never below `low`. Channel, covariate and
    description belong to outside effects.
    """

    name: str
    place: str
    low: float
    high: float
    parameters: Callable[[float], Parameters]
    channel: str = ""
    covariate: str = ""
    description: str = ""
    fixed: bool = False
    clamped: bool = False

    def effect(self, size: float) -> Effect:
        """Return the effect of that size."""
        return Effect(self.name, self.parameters(size))

    def seen_in(self, channel: str, covariate: str, description: str) -> "Recipe":
        """Return a copy that names where an outside effect shows, and on what it depends."""
        return replace(self, channel=channel, covariate=covariate, description=description)


Sized = list[tuple[Recipe, float]]


@dataclass(frozen=True)
class Draft:
    """The numbers that a recipe is drawn from; `direction` is the sign (+1 or -1) that a signed effect gets."""

    name: str
    place: str
    rng: np.random.Generator
    direction: float

    def grows(
        self, low: float, high: float, parameters: Callable[[float], Parameters], *, clamped: bool = False
    ) -> Recipe:
        """Return a recipe with any dependence on the size."""
        return Recipe(self.name, self.place, low, high, parameters, clamped=clamped)

    def fixed(self, **parameters: float) -> Recipe:
        """Return a recipe whose parameters are drawn outright."""
        return Recipe(self.name, self.place, 0.5, 1.0, lambda _: dict(parameters), fixed=True)

    def positive(self, low: float, high: float, key: str, first: Parameters | None = None, **more: float) -> Recipe:
        """Return a recipe with parameters[key] = size, between the constant parameters `first` and `more`."""
        return self.grows(low, high, lambda size: {**(first or {}), key: size, **more})

    def signed(self, low: float, high: float, key: str, first: Parameters | None = None, **more: float | str) -> Recipe:
        """Return a recipe with parameters[key] = direction * size."""
        return self.grows(low, high, lambda size: {**(first or {}), key: self.direction * size, **more})

    def scaled(self, low: float, high: float, key: str = "scale") -> Recipe:
        """Return a recipe with parameters[key] = exp(direction * size), a factor."""
        return self.grows(low, high, lambda size: {key: math.exp(self.direction * size)})


@dataclass(frozen=True)
class Variant:
    """One version of the true robot: listed effects, outside effects, and shifts of parameters in tolerances."""

    effects: tuple[Effect, ...] = ()
    outside: tuple[Effect, ...] = ()
    shifts: Mapping[str, float] = field(default_factory=dict)

    def individual(self, drawn: Mapping[str, float], nominal: Mapping[str, Toleranced]) -> dict[str, float]:
        """Return the drawn individual parameters with the shifts; units are those of the parameters."""
        return {key: value + self.shifts.get(key, 0.0) * nominal[key][1] for key, value in drawn.items()}


def variant_of(sized: Sized) -> Variant:
    """Return the robot with exactly these effects."""
    listed = tuple(recipe.effect(size) for recipe, size in sized if recipe.place != "outside")
    outside = tuple(recipe.effect(size) for recipe, size in sized if recipe.place == "outside")
    return Variant(listed, outside)
