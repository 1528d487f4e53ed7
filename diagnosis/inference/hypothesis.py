"""A hypothesis: the nominal robot with its tolerances, and the effects that the real one is said to have.

Its numbers are one vector: first the nominal parameters that differ from unit to unit, each with a normal prior of its
tolerance, then those of the effects, without a prior. A deviation within tolerance is thereby no discovery: the
nuisances are fitted beside every effect, and take it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp
from types import MappingProxyType
from typing import Any

import numpy as np

from configs.effects.base import Effect
from configs.schema.robot import RobotConfig
from diagnosis.inference.coordinate import Coordinate
from diagnosis.nuisances import Nuisance
from symolo.core.arrays import Array

RELATIVE = 3.0
"""Tolerances from which a value is positive by nature."""


@dataclass(frozen=True)
class CandidateEffect:
    """An effect that may be the cause: its class and its choices, with open numbers."""

    kind: type[Effect]
    choices: tuple[tuple[str, str], ...] = ()

    @property
    def name(self) -> str:
        """Canonical, `tof_mount_yaw[left]` where it has a choice."""
        choice = ",".join(value for _, value in self.choices)
        return f"{self.kind.name}[{choice}]" if choice else self.kind.name

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        return tuple(Coordinate.of_parameter(name, number) for name, number in self.kind.parameters().items())

    def on(self, robot: RobotConfig, values: Mapping[str, float]) -> RobotConfig:
        """The robot with this effect. Bounds are those of the coordinates, so that nothing is checked again."""
        numbers: dict[str, Any] = {**dict(self.choices), **values}
        present = robot.effects.get(self.kind)
        if present is not None:
            # The nominal robot has an offset or scale of that name already; the effect comes on top of it.
            numbers |= {
                name: getattr(present, name) * value
                if self.kind.parameters()[name].null == 1.0
                else getattr(present, name) + value
                for name, value in values.items()
            }
        return robot.with_effect(self.kind.model_construct(**numbers))


@dataclass(frozen=True)
class Hypothesis:
    nominal: RobotConfig
    nuisances: tuple[Nuisance, ...]
    effects: tuple[CandidateEffect, ...] = ()
    held: tuple[int, float] | None = None
    """Place of a coordinate that no fit may move, and where it stays."""

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """(P,), nuisances first."""
        spreads = (Coordinate.of_spread(n.name, n.tolerance) for n in self.nuisances)
        found = [*spreads, *(c for effect in self.effects for c in effect.coordinates)]
        if self.held is not None:
            place, x = self.held
            found[place] = replace(found[place], low=x, high=x)
        return tuple(found)

    @property
    def size(self) -> int:
        return len(self.coordinates)

    def prior(self, x: Array) -> Array:
        """Standardised deviations of the nuisances, (..., number of nuisances), of coordinates (..., P)."""
        return x[..., : len(self.nuisances)]

    def clipped(self, x: Array) -> Array:
        """Coordinates (..., P) within their bounds."""
        low = np.array([c.low for c in self.coordinates])
        high = np.array([c.high for c in self.coordinates])
        return np.clip(x, low, high)

    def null(self) -> Array:
        """(P,), of no effect; shapes at their start."""
        return np.array([c.start if c.null is None else c.null for c in self.coordinates])

    def robot(self, x: Array) -> RobotConfig:
        """Of one vector of coordinates, (P,)."""
        robot, k = self.nominal, len(self.nuisances)
        for effect in self.effects:
            numbers = {c.name: float(c.value(x[k + i])) for i, c in enumerate(effect.coordinates)}
            k += len(numbers)
            robot = effect.on(robot, numbers)
        for nuisance, deviation in zip(self.nuisances, x.tolist(), strict=False):
            robot = nuisance.applied(robot, deviated(nuisance, deviation))
        return robot

    def robots(self, x: Array) -> list[RobotConfig]:
        """Of vectors (M, P)."""
        return [self.robot(row) for row in x]

    def parameters(self, effect: CandidateEffect) -> slice:
        """Where an effect's numbers stand in the vector."""
        k = len(self.nuisances)
        for other in self.effects:
            if other == effect:
                return slice(k, k + len(effect.coordinates))
            k += len(other.coordinates)
        raise KeyError(effect.name)

    def values(self, effect: CandidateEffect, x: Array) -> Mapping[str, float]:
        """An effect's numbers in their units."""
        found = x[self.parameters(effect)]
        return MappingProxyType({c.name: float(c.value(v)) for c, v in zip(effect.coordinates, found, strict=True)})

    def with_effect(self, effect: CandidateEffect) -> "Hypothesis":
        return Hypothesis(self.nominal, self.nuisances, (*self.effects, effect))

    def with_held(self, place: int, x: float) -> "Hypothesis":
        """With one coordinate held."""
        return replace(self, held=(place, x))

    def without(self, effect: CandidateEffect) -> "Hypothesis":
        return Hypothesis(self.nominal, self.nuisances, tuple(e for e in self.effects if e != effect))


def deviated(nuisance: Nuisance, deviation: float) -> float:
    """A nominal parameter that is so many tolerances off.

    What is positive by nature goes by its logarithm, as a factor on it does: of a parameter and its factor the data
    hold the product alone, and only along a straight valley does a fit find to the end of it.
    """
    if nuisance.value > RELATIVE * nuisance.tolerance:
        return nuisance.value * exp(deviation * nuisance.tolerance / nuisance.value)
    return nuisance.value + deviation * nuisance.tolerance


def moved(x: Array, of: Hypothesis, to: Hypothesis) -> Array:
    """Coordinates of one hypothesis as those of another; effects that it lacked at their null."""
    found = to.null()
    nuisances = len(to.nuisances)
    found[:nuisances] = x[:nuisances]
    for effect in to.effects:
        if effect in of.effects:
            found[to.parameters(effect)] = x[of.parameters(effect)]
    return found
