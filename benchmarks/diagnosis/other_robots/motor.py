"""Motors of very different size."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array, log_uniform, pick, significant
from benchmarks.diagnosis.other_robots.files import tolerance_entry

SUPPLIES_V = [1.5, 3.0, 4.5, 6.0, 7.4, 9.0, 11.1, 12.0, 14.8, 18.0, 24.0]
SYMBOLS = ["R", "K", "B", "Tc", "J"]
SPREAD = {"R": 0.010, "K": 0.007, "B": 0.05, "Tc": 0.04, "J": 0.02}


@dataclass
class Motor:
    """A nominal motor, all quantities at the wheel shaft, with relative tolerances."""

    R: float
    K: float
    B: float
    Tc: float
    J: float
    supply: float
    relative: dict[str, float]
    entries: dict[str, Any]
    """Section `motor` of nominal.yaml."""

    def individual(self, deviations: Array) -> dict[str, Array]:
        """Return the parameters at deviations (last axis R, K, B, Tc and maybe J), as columns."""
        out = {}
        for i, name in enumerate(SYMBOLS[: deviations.shape[-1]]):
            value = getattr(self, name)
            out[name] = (value * np.maximum(1 + deviations[..., i] * self.relative[name], 0.05))[..., None]
        return out

    def no_load_current(self, voltage: float | None = None) -> float:
        """Return the current at no load, at full voltage where none is given."""
        return self.Tc / self.K + self.B * (voltage or self.supply) / self.K**2


def draw_motor(rng: np.random.Generator, *, inertia: bool, top_speed: float | None = None) -> Motor:
    """Return a motor between a toy on one cell and a 24 V gear motor; `inertia` lists the inertia in its entries."""
    supply = pick(rng, SUPPLIES_V)
    top = top_speed or log_uniform(rng, 4, 70)
    k = supply / top
    stall = log_uniform(rng, 0.4, 7.0)
    r = supply / stall
    idle = stall * log_uniform(rng, 0.025, 0.16)
    coulomb_share = rng.uniform(0.35, 0.85)
    tc = k * idle * coulomb_share
    b = k * idle * (1 - coulomb_share) / top
    tau = log_uniform(rng, 0.02, 0.25)
    j = tau * (k * k / r + b)
    loose = pick(rng, [log_uniform(rng, 0.3, 1.0), log_uniform(rng, 1.0, 4.0)])
    drawn = {n: float(np.clip(s * loose * log_uniform(rng, 0.6, 1.6), 0.002, 0.2)) for n, s in SPREAD.items()}
    toleranced = {
        "winding_resistance_ohm": tolerance_entry(r, drawn["R"]),
        "torque_constant_N_m_A": tolerance_entry(k, drawn["K"]),
        "viscous_friction_N_m_s_rad": tolerance_entry(b, drawn["B"]),
        "coulomb_friction_N_m": tolerance_entry(tc, drawn["Tc"]),
    }
    if inertia:
        toleranced["rotor_inertia_kg_m2"] = tolerance_entry(j, drawn["J"])
    by_symbol = dict(zip(SYMBOLS, toleranced.values(), strict=False))
    rounded = {"J": significant(j), **{name: entry["value"] for name, entry in by_symbol.items()}}
    relative = {**drawn, **{name: entry["tolerance"] / entry["value"] for name, entry in by_symbol.items()}}
    return Motor(**rounded, supply=supply, relative=relative, entries={**toleranced, "supply_voltage_V": supply})
