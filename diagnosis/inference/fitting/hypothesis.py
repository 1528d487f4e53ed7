"""A hypothesis: the nominal robot with the tolerances of its parameters, and the effects of the real robot.

All parameters form one vector of coordinates. First come the nuisances, the nominal parameters that differ from unit to
unit, each with a normal prior of its tolerance. Then come the parameters of the effects, without a prior. A deviation
within its tolerance is therefore no discovery: the nuisances are fitted together with every effect, and explain it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, log
from types import MappingProxyType
from typing import Any

import numpy as np

from configs.effects.base import Effect
from configs.schema.robot import RobotConfig
from diagnosis.inference.fitting.coordinate import Coordinate
from diagnosis.inference.fitting.motor_scales import UNSCALED, MotorScales, motor_scales
from diagnosis.measured.channel import Mask
from diagnosis.nuisances import Nuisance, with_values
from symolo.core.arrays import Array

POSITIVE_TOLERANCES = 3.0
"""Value of a nominal parameter in tolerances from which it counts as positive by nature."""


@dataclass(frozen=True)
class CandidateEffect:
    """A registered effect with its discrete choices; its parameters are free."""

    kind: type[Effect]
    choices: tuple[tuple[str, str], ...] = ()
    shape: tuple[tuple[str, float], ...] = ()
    """Numbers that are not fitted, since the nominal robot has the effect with this shape already."""
    scales: MotorScales = UNSCALED
    """Sizes of the motor, by which the start values are scaled."""

    @classmethod
    def on_top_of(
        cls, nominal: RobotConfig, kind: type[Effect], choices: tuple[tuple[str, str], ...]
    ) -> "CandidateEffect | None":
        """Return a candidate for a nominal robot; None if the robot has the effect with another choice."""
        present, scales = nominal.effects.get(kind), motor_scales(nominal)
        if present is None:
            return cls(kind, choices, scales=scales)
        if any(getattr(present, name) != value for name, value in choices):
            return None
        numbers = kind.parameters().items()
        shape = tuple((n, getattr(present, n)) for n, number in numbers if number.null is None)
        return cls(kind, choices, shape, scales)

    @property
    def name(self) -> str:
        """Name with the choices, such as `tof_mount_yaw[left]`."""
        choice = ",".join(value for _, value in self.choices)
        return f"{self.kind.name}[{choice}]" if choice else self.kind.name

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        numbers = self.kind.parameters().items()
        return tuple(
            # A measured number is that of this motor already.
            Coordinate.from_parameter(name, number, self.scales.factor(number) if number.std is None else 1.0)
            for name, number in numbers
            if name not in self.known
        )

    @cached_property
    def known(self) -> Mapping[str, float]:
        """Numbers that are not fitted, with their values."""
        fields, numbers = self.kind.model_fields, self.kind.parameters().items()
        defaults = {name: fields[name].default for name, number in numbers if number.is_known}
        return MappingProxyType({**defaults, **dict(self.shape)})

    def on(self, robot: RobotConfig, values: Mapping[str, float]) -> RobotConfig:
        """Return the robot with this effect. The coordinates hold the bounds, so values are not validated again.

        Raises:
            ValueError: The robot has the effect with another choice.
        """
        numbers: dict[str, Any] = {**dict(self.choices), **self.known, **values}
        present = robot.effects.get(self.kind)
        if present is not None:
            other = tuple((name, getattr(present, name)) for name, _ in self.choices)
            if other != self.choices:
                there = CandidateEffect(self.kind, other).name
                raise ValueError(f"{self.name}: the nominal robot has {there}, and a robot has each effect once")
            numbers |= {name: self._on_top(name, getattr(present, name), value) for name, value in values.items()}
        return robot.with_effect(self.kind.model_construct(**numbers))

    def _on_top(self, name: str, present: float, value: float) -> float:
        """Return a number of an effect that the nominal robot has already, with this effect on top of it."""
        parameter = self.kind.parameters()[name]
        if parameter.null is None:
            return present
        if parameter.null == parameter.high:
            return min(present, value)
        return present * value if parameter.null == 1.0 else present + value


@dataclass(frozen=True)
class Hypothesis:
    """A nominal robot, its nuisances and its effects."""

    nominal: RobotConfig
    nuisances: tuple[Nuisance, ...]
    effects: tuple[CandidateEffect, ...] = ()
    fixed: tuple[tuple[int, float], ...] = ()
    """Indices of the coordinates that no fit may change, and their values."""

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The P coordinates, nuisances first."""
        nuisances = (Coordinate.from_tolerance(n.name, n.tolerance, n.bounds) for n in self.nuisances)
        coordinates = [*nuisances, *(c for effect in self.effects for c in effect.coordinates)]
        for place, x in self.fixed:
            coordinates[place] = replace(coordinates[place], low=x, high=x)
        return tuple(coordinates)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the coordinates, (P,) each."""
        return np.array([c.low for c in self.coordinates]), np.array([c.high for c in self.coordinates])

    @property
    def size(self) -> int:
        return len(self.coordinates)

    def prior(self, x: Array) -> Array:
        """Return the standardised deviations of the nuisances, (..., number of nuisances), for coordinates (..., P)."""
        return x[..., : len(self.nuisances)]

    def clipped(self, x: Array) -> Array:
        """Return coordinates (..., P) within their bounds."""
        return np.clip(x, *self.bounds)

    def scaled(self, effect: "CandidateEffect", x: Array, factor: float, *, with_limits: bool = False) -> Array:
        """Return coordinates (P,) with the amplitudes of one effect multiplied by a factor, within their bounds.

        Its limits stay as they are, or are multiplied themselves, which makes the effect smaller and not larger.
        """
        y = x.copy()
        for place, c in enumerate(effect.coordinates, self.parameters(effect).start):
            if c.is_ceiling:
                y[place] += log(factor) if with_limits else 0.0
            elif c.null is not None:
                y[place] = c.null + factor * (x[place] - c.null)
        return self.clipped(y)

    def null(self) -> Array:
        """Return the coordinates (P,) without effect; shape parameters have their start value."""
        return np.array([c.start if c.null is None else c.null for c in self.coordinates])

    def robot(self, x: Array) -> RobotConfig:
        """Return the robot with coordinates (P,)."""
        robot = self.nominal
        for effect in self.effects:
            robot = effect.on(robot, self.values(effect, x))
        deviations = zip(self.nuisances, x.tolist(), strict=False)
        return with_values(robot, ((nuisance, deviated(nuisance, deviation)) for nuisance, deviation in deviations))

    def local_change(self, x: Array) -> Array | float:
        """Return the change (..., N) of the samples by all that is no property of the robot, at coordinates (..., P).

        These are small errors, such as the heading of a tracked body in one session, and enter linearly.
        """
        return x[..., self.is_local] @ self._changes + self._rest if self.is_local.any() else 0.0

    @cached_property
    def is_local(self) -> Mask:
        """(P,), whether a coordinate is a nuisance of some of the rows, and no property of the robot."""
        local = [nuisance.change is not None for nuisance in self.nuisances]
        return np.array([*local, *(False for effect in self.effects for _ in effect.coordinates)], dtype=bool)

    def of_robot(self, x: Array) -> "tuple[Hypothesis, Array]":
        """Return the hypothesis without the nuisances that are no property of the robot, and its coordinates."""
        robot_nuisances = tuple(nuisance for nuisance in self.nuisances if nuisance.change is None)
        return replace(self, nuisances=robot_nuisances), x[~self.is_local]

    @cached_property
    def _changes(self) -> Array:
        return np.stack([nuisance.change for nuisance in self.nuisances if nuisance.change is not None])

    @cached_property
    def _rest(self) -> Array | float:
        return sum((nuisance.rest for nuisance in self.nuisances if nuisance.rest is not None), start=0.0)

    def robots(self, x: Array) -> list[RobotConfig]:
        """Return the robots with coordinates (M, P)."""
        return [self.robot(row) for row in x]

    def parameters(self, effect: CandidateEffect) -> slice:
        """Return where the parameters of an effect stand in the vector."""
        k = len(self.nuisances)
        for other in self.effects:
            if other == effect:
                return slice(k, k + len(effect.coordinates))
            k += len(other.coordinates)
        raise KeyError(effect.name)

    def values(self, effect: CandidateEffect, x: Array) -> Mapping[str, float]:
        """Return the parameters of an effect in their units."""
        values = x[self.parameters(effect)]
        return MappingProxyType({c.name: float(c.value(v)) for c, v in zip(effect.coordinates, values, strict=True)})

    def std(self, effect: CandidateEffect, x: Array, covariance: Array) -> dict[str, float]:
        """Return the standard errors of an effect's parameters in their units.

        Args:
            effect: One of the effects.
            x: (P,), coordinates.
            covariance: (P, P), of the coordinates.
        """
        places = self.parameters(effect)
        errors = np.sqrt(np.diag(covariance)[places]).tolist()
        columns = zip(effect.coordinates, x[places].tolist(), errors, strict=True)
        return {c.name: abs(c.slope(value)) * error for c, value, error in columns}

    def with_effect(self, effect: CandidateEffect) -> "Hypothesis":
        return Hypothesis(self.nominal, self.nuisances, (*self.effects, effect))

    def with_fixed(self, place: int, x: float) -> "Hypothesis":
        """Return the hypothesis with one more coordinate fixed."""
        return replace(self, fixed=(*self.fixed, (place, x)))

    def without(self, effect: CandidateEffect) -> "Hypothesis":
        return Hypothesis(self.nominal, self.nuisances, tuple(e for e in self.effects if e != effect))

    def added_to(self, base: "Hypothesis") -> CandidateEffect:
        """Return the one effect that this hypothesis has and `base` lacks."""
        (effect,) = (effect for effect in self.effects if effect not in base.effects)
        return effect


def deviated(nuisance: Nuisance, deviation: float) -> float:
    """Return a nominal parameter with a deviation in tolerances.

    Parameters that are positive by nature deviate by a factor, like the effects that scale them: the data determine
    only the product of a parameter and its factor, and a fit follows such a valley to its end only if it is straight.
    """
    if nuisance.value > POSITIVE_TOLERANCES * nuisance.tolerance:
        return nuisance.value * exp(deviation * nuisance.tolerance / nuisance.value)
    return nuisance.value + deviation * nuisance.tolerance


def moved(x: Array, source: Hypothesis, target: Hypothesis) -> Array:
    """Return coordinates of the hypothesis `source` as those of `target`; effects that `source` lacks are absent."""
    y = target.null()
    y[: len(target.nuisances)] = x[: len(target.nuisances)]
    for effect in target.effects:
        if effect in source.effects:
            y[target.parameters(effect)] = x[source.parameters(effect)]
    return y
