"""Nuisances: parameters in which each unit differs from the nominal robot without a fault.

A measured case states each as a value and a tolerance, which is the standard deviation between units. A fit has each of
them as a parameter with that prior, in addition to the effects that it tests.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import (
    KnownWheels,
    Nominal,
    NominalDrive,
    NominalLog,
    NominalRobot,
    NominalTof,
    PositiveSpread,
    Spread,
)
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.range_scale import RangeScale
from symolo.core.arrays import Array

Number = float | NDArray[np.float64]


@dataclass(frozen=True)
class SectionField:
    """A field of a section of the robot, which several parameters of a case may change in one copy."""

    section: str
    key: str
    factor: float
    """Ratio of the field to the parameter of the case."""

    def __call__(self, robot: RobotConfig, value: Number) -> RobotConfig:
        """Return the robot with another value of the parameter."""
        return robot.with_section(self.section, {self.key: self.factor * value})


@dataclass(frozen=True)
class Nuisance:
    """One parameter with its tolerance."""

    name: str
    """Name of the parameter in nominal.yaml."""
    value: float
    """Value of the nominal robot."""
    tolerance: float
    """Standard deviation between units."""
    unit: str
    change_robot: Callable[[RobotConfig, Number], RobotConfig]
    """Function that returns a robot with another value of the parameter, or with an array for many robots at once
    (`physics.robot.stack`). The robot has all its effects: what they add or scale applies on top of the value, and an
    effect of the same name, added later, would replace it."""
    change: Array | None = field(default=None, compare=False, repr=False)
    """(N,), change of each sample by one tolerance, of a parameter that only some of the rows have, such as those of a
    session; None for parameters of the robot."""
    bounds: tuple[float, float] = field(default=(-inf, inf), kw_only=True)
    """Smallest and largest deviation, in tolerances."""
    meaning: str = field(default="", kw_only=True)
    """Meaning of a number that no nominal.yaml has, so that its tolerance is assumed; empty for the others."""
    rest: Array | None = field(default=None, compare=False, repr=False)
    """(N,), change of each sample that the multiple of `change` lacks at any size; None for none."""


STEP = 0.25
"""Step of a derivative in tolerances."""


def change_by_tolerance(more: Array, less: Array) -> Array:
    """Return the change of samples by one tolerance from predictions STEP above and STEP below a value."""
    return 0.5 * (more - less) / STEP


def nuisances(nominal: Nominal) -> tuple[Nuisance, ...]:
    """Return every parameter of a case with a tolerance above 0."""
    return tuple(nuisance for nuisance in _all(nominal) if nuisance.tolerance > 0.0)


def _all(nominal: Nominal) -> Iterator[Nuisance]:
    if isinstance(nominal, NominalLog):
        return  # such a case states no tolerances
    if isinstance(nominal, NominalTof):
        yield _range_offset(nominal.tof.range_offset_m)
        yield _range_scale(nominal.tof.range_scale)
        return
    if isinstance(nominal, KnownWheels):
        yield from _wheels(nominal.robot)
        yield _wheel_asymmetry(nominal.wheel_radius_asymmetry)
        return
    if nominal.motor is not None:
        for name, field in nominal.motor:
            if isinstance(field, (PositiveSpread, Spread)):
                yield section_nuisance("motor", name, name, field.value, field.tolerance)
    if isinstance(nominal, NominalDrive):
        yield from _wheels(nominal.robot)
        if nominal.tof is not None:
            yield _range_offset(nominal.tof.range_offset_m)
        if nominal.motor is not None:
            yield command_timing()
        yield creep_on_the_spot()


def _wheels(robot: NominalRobot) -> Iterator[Nuisance]:
    radius, separation = robot.wheel_radius_m, robot.wheel_separation_m
    yield section_nuisance("drive", "wheel_diameter_m", "wheel_radius_m", radius.value, radius.tolerance, factor=2.0)
    yield section_nuisance("drive", "track_m", "wheel_separation_m", separation.value, separation.tolerance)


def _wheel_asymmetry(spread: Spread) -> Nuisance:
    def changed(robot: RobotConfig, value: Number) -> RobotConfig:
        present = robot.effects.get(WheelRadiusAsymmetry) or WheelRadiusAsymmetry.null()
        return robot.with_effect(WheelRadiusAsymmetry.model_construct(asymmetry=present.asymmetry + value))

    return Nuisance("wheel_radius_asymmetry", spread.value, spread.tolerance, "1", changed)


TIMING_S = 5e-4
"""Time by which a voltage may act later than logged without a fault, because of rounded times, a control loop between
two samples, or the integration steps of a simulation. A delay that matters with rows of 50 ms is much longer."""


def command_timing() -> Nuisance:
    """Return the nuisance for the timing of a drive's voltages."""

    def changed(robot: RobotConfig, value: Number) -> RobotConfig:
        present = robot.effects.get(InputDelay) or InputDelay.null()
        return robot.with_effect(InputDelay.model_construct(delay_s=present.delay_s + np.maximum(value, 0.0)))

    meaning = "the time by which the voltages act later than the log states"
    return Nuisance("command_timing_s", 0.0, TIMING_S, "s", changed, meaning=meaning)


CREEP_ON_THE_SPOT = 0.5
"""Tolerance of the creep in a turn on the spot, relative to that on a straight line. It is 1 if tyres creep as they
roll, and 0 if the robot creeps only while its middle moves; no source says which of them is true for a floor."""


def creep_on_the_spot() -> Nuisance:
    """Return the nuisance for the creep of a sloping floor under a robot that turns on the spot."""

    def changed(robot: RobotConfig, value: Number) -> RobotConfig:
        present = robot.effects.get(FloorSlope)
        if present is None:
            return robot
        fields = {**dict(present), "on_the_spot": present.on_the_spot * value}
        return robot.with_effect(FloorSlope.model_construct(**fields))

    name, lowest = "creep_on_the_spot", -1.0 / CREEP_ON_THE_SPOT
    meaning = "the creep down a slope in a turn on the spot, relative to that on a straight line"
    return Nuisance(name, 1.0, CREEP_ON_THE_SPOT, "1", changed, bounds=(lowest, 0.0), meaning=meaning)


UNITS = {"ohm": "ohm", "N_m_A": "N m/A", "N_m_s_rad": "N m s/rad", "N_m": "N m", "kg_m2": "kg m2", "m": "m"}


def section_nuisance(
    section: str, key: str, name: str, value: float, tolerance: float, *, factor: float = 1.0
) -> Nuisance:
    """Return the nuisance of a robot parameter, which is `factor` times that of the case."""
    unit = next(unit for end, unit in UNITS.items() if name.endswith(f"_{end}"))
    return Nuisance(name, value, tolerance, unit, SectionField(section, key, factor))


def _range_offset(spread: Spread) -> Nuisance:
    def changed(robot: RobotConfig, value: Number) -> RobotConfig:
        present = robot.effects.get(RangeOffset) or RangeOffset.model_construct(offset_m=spread.value)
        return robot.with_effect(RangeOffset.model_construct(offset_m=present.offset_m + (value - spread.value)))

    return Nuisance("range_offset_m", spread.value, spread.tolerance, "m", changed)


def _range_scale(spread: PositiveSpread) -> Nuisance:
    def changed(robot: RobotConfig, value: Number) -> RobotConfig:
        present = robot.effects.get(RangeScale) or RangeScale.model_construct(scale=spread.value)
        return robot.with_effect(RangeScale.model_construct(scale=present.scale * (value / spread.value)))

    return Nuisance("range_scale", spread.value, spread.tolerance, "1", changed)


def with_values(robot: RobotConfig, values: Iterable[tuple[Nuisance, Number]]) -> RobotConfig:
    """Return a robot with other values of several parameters, each of which is in `values` once."""
    sections: dict[str, dict[str, Number]] = {}
    for nuisance, value in values:
        change = nuisance.change_robot
        if isinstance(change, SectionField):
            sections.setdefault(change.section, {})[change.key] = change.factor * value
        else:
            robot = change(robot, value)
    copies = {name: getattr(robot, name).model_copy(update=changed) for name, changed in sections.items()}
    return robot.model_copy(update=copies) if copies else robot
