"""Gear motors of small robots, as they are drawn and as nominal.yaml shows them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick, significant
from benchmarks.diagnosis.independent_cases.recipes import Toleranced

TOLERANCE = {"R": 0.01, "K": 0.007, "B": 0.05, "Tc": 0.04, "J": 0.02}
COLUMNS = {
    "R": "winding_resistance_ohm",
    "K": "torque_constant_N_m_A",
    "B": "viscous_friction_N_m_s_rad",
    "Tc": "coulomb_friction_N_m",
    "J": "rotor_inertia_kg_m2",
}
SUPPLIES_V = [2.4, 3.0, 3.7, 4.5, 5.0, 6.0, 7.4, 9.0, 11.1, 12.0, 14.8, 18.0, 24.0]


@dataclass(frozen=True)
class Motor:
    """Nominal motor at the wheel shaft: R [ohm], K [N m/A], B [N m s/rad], Tc [N m], J [kg m2], each with tolerance."""

    nominal: dict[str, Toleranced]
    supply_V: float

    def value(self, key: str) -> float:
        """Return one nominal parameter in its SI unit."""
        return self.nominal[key][0]

    def section(self, keys: Sequence[str]) -> dict[str, Any]:
        """Return the section `motor` of nominal.yaml with those parameters."""
        section: dict[str, Any] = {COLUMNS[k]: value_with_tolerance(self.nominal[k]) for k in keys}
        section["supply_voltage_V"] = self.supply_V
        return section


def value_with_tolerance(entry: Toleranced) -> dict[str, float]:
    """Return the mapping that nominal.yaml has for a parameter."""
    return {"value": entry[0], "tolerance": entry[1]}


def draw_motor(rng: np.random.Generator, full_speed_rad_s: float | None = None) -> Motor:
    """Draw a motor of 2 to 24 V, 0.5 to 20 ohm, and 4 to 60 rad/s at full supply or the speed that is passed.

    The no-load current is 3 to 15 % of the stall current; 30 to 85 % of the no-load friction is Coulomb friction; the
    mechanical time constant is 0.03 to 0.25 s. These ranges cover the data sheets of common gear motors.
    """
    supply = pick(rng, SUPPLIES_V)
    if rng.random() < 0.3:
        supply = round(log_uniform(rng, 2, 24), 1)
    speed = full_speed_rad_s or log_uniform(rng, 4, 60)
    resistance = log_uniform(rng, 0.5, 20)
    idle = log_uniform(rng, 0.03, 0.15) * supply / resistance
    constant = (supply - resistance * idle) / speed
    friction = constant * idle
    coulomb = friction * rng.uniform(0.3, 0.85)
    viscous = (friction - coulomb) / speed
    inertia = log_uniform(rng, 0.03, 0.25) * (constant**2 + viscous * resistance) / resistance
    nominal = {}
    for key, value in {"R": resistance, "K": constant, "B": viscous, "Tc": coulomb, "J": inertia}.items():
        rounded = significant(value)
        nominal[key] = (rounded, significant(rounded * TOLERANCE[key] * rng.uniform(0.6, 1.6), 5))
    return Motor(nominal, supply)


def draw_individual(rng: np.random.Generator, nominal: Mapping[str, Toleranced], factor: float) -> dict[str, float]:
    """Draw one robot: value + factor * tolerance * normal deviate for every parameter."""
    return {
        key: value + factor * tolerance * float(rng.standard_normal()) for key, (value, tolerance) in nominal.items()
    }
