"""The true motor: current and friction as functions of voltage, speed and wheel angle, with all effects on them.

Units: ohm, N m/A, N m s/rad, N m, kg m2, V, A, rad/s, rad, s. Equations without a source are those of the format.
"""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np

from benchmarks.diagnosis.independent_cases.recipes import Array

Value = Any  # a number, or an array over samples; in Lanes an array over lanes and samples


@dataclass
class Law:
    """The numbers of one motor. The defaults of the effects' numbers stand for no effect."""

    R: Value
    K: Value
    B: Value
    Tc: Value
    J: Value
    U: Value  # supply voltage
    asymmetry: Value = 0.0
    extra: Value = 0.0  # Stribeck torque, with its speed
    extra_speed: Value = 1.0
    drag: Value = 0.0
    drop: Value = 0.0
    source: Value = 0.0  # series resistance of the supply
    limit: Value = np.inf
    coast: Value = 0.0  # 1 where the bridge lets the motor coast, with inductance, diode voltage, frequency (Hz)
    L: Value = 1e-3
    diode: Value = 0.0
    switching: Value = 1e3
    ripple: Value = 0.0  # amplitude of a torque with the wheel angle, with cycles per turn and phase
    cycles: Value = 1.0
    ripple_phase: Value = 0.0
    bump: Value = 0.0  # height of a local bump of friction, with its speed and width
    bump_speed: Value = 1.0
    bump_width: Value = 1.0
    dead: Value = 0.0  # voltage up to which the bridge gives none

    def multiply(self, key: str, factor: Value) -> None:
        """Multiply one number in place."""
        setattr(self, key, getattr(self, key) * factor)


KEYS = [entry.name for entry in fields(Law)]


def plain_law(individual: Mapping[str, float], supply_V: float) -> Law:
    """Return the nominal equations with the parameters of one robot."""
    parameters = {key: individual[key] for key in ("R", "K", "B", "Tc")}
    return Law(**parameters, J=individual.get("J", 1.0), U=supply_V)


@dataclass
class Lanes(Law):
    """Many motors side by side: every number is an array (lanes, 1) or (lanes, samples), or (lanes,) of one sample."""

    features: frozenset[str] = frozenset()  # numbers by which some lane is not linear beside Coulomb friction

    def __post_init__(self) -> None:
        self.features = frozenset(
            [key for key in ("coast", "ripple", "bump", "extra", "drag") if np.any(getattr(self, key) != 0)]
            + ["limit"] * bool(np.any(np.isfinite(self.limit)))
        )

    @classmethod
    def stack(cls, laws: Sequence[Law]) -> Self:
        """Put the laws side by side."""
        arrays = {}
        for key in KEYS:
            values = [np.atleast_1d(np.asarray(getattr(law, key), float)) for law in laws]
            width = max(v.shape[-1] for v in values)
            arrays[key] = np.stack([np.broadcast_to(v, (width,)) for v in values])
        return cls(**arrays)

    def times(self, **factors: Value) -> Self:
        """Return a copy with some numbers multiplied."""
        numbers = {key: getattr(self, key) for key in KEYS}
        return type(self)(**{key: x * factors[key] if key in factors else x for key, x in numbers.items()})

    def column(self, k: int) -> Self:
        """Return the lanes at sample k."""
        lanes = copy.copy(self)
        for key in KEYS:
            array = getattr(self, key)
            setattr(lanes, key, array[:, k if array.shape[1] > 1 else 0])
        return lanes

    @property
    def varies(self) -> bool:
        """Whether some law depends on the sample."""
        return any(getattr(self, key).shape[1] > 1 for key in KEYS)


def coasting_current(p: Lanes, u: Array, w: Array) -> Array:
    """Return the mean current (A) of a bridge that is on for duty * period and open for the rest.

    While it is open, the current flows through the diodes back into the supply, so that the terminal voltage is
    -(U + diode_V), until the current is zero; it then stays zero (discontinuous conduction). The speed is constant
    over one period. The solution of L i' = v - R i - K w in both parts is exact.
    """
    direction = np.sign(u)
    duty = np.clip(np.abs(u) / p.U, 0, 1)
    ahead = direction * w
    rise = np.maximum((p.U - p.K * ahead) / p.R, 0.0)
    fall = np.maximum((p.U + p.diode + p.K * ahead) / p.R, 1e-9)
    tau = p.L / p.R
    period = 1.0 / p.switching
    on = duty * period
    built = -np.expm1(-on / tau)
    peak = rise * built
    off = tau * np.log1p(peak / fall)
    charge = rise * (on - tau * built) - fall * off + tau * peak
    steady = (duty * p.U - (1 - duty) * (p.U + p.diode) - p.K * ahead) / p.R
    amps = np.where(on + off < period, charge / period, np.maximum(steady, 0.0))
    return np.where(duty > 0, direction * amps, 0.0)


def current(p: Lanes, u: Array, w: Array) -> Array:
    """Return the motor current (A) at the commanded voltage u (V) and the wheel speed w (rad/s)."""
    u = np.where(np.abs(u) > p.dead, u, 0.0)
    e = u - p.K * w
    amps = np.sign(e) * np.maximum(np.abs(e) - p.drop, 0.0) / (p.R + p.source * (u / p.U) ** 2)
    if "coast" in p.features:
        amps = np.where(p.coast > 0, coasting_current(p, u, w), amps)
    if "limit" in p.features:
        amps = np.clip(amps, -p.limit, p.limit)
    return amps


def dry_friction(p: Lanes, speed: Array | float, direction: Array) -> Array:
    """Return the friction torque (N m) without its viscous part at abs(w) = speed (rad/s) in that direction."""
    torque = p.Tc * (1 - p.asymmetry * direction)
    if "extra" in p.features:
        torque = torque + p.extra * np.exp(-np.minimum((speed / p.extra_speed) ** 2, 700.0))
    if "drag" in p.features:
        torque = torque + p.drag * speed**2
    if "bump" in p.features:
        torque = torque + p.bump * np.exp(-np.minimum(((speed - p.bump_speed) / p.bump_width) ** 2, 700.0))
    return torque


def angle_torque(p: Lanes, angle: Array) -> Array | float:
    """Return the load torque (N m) that depends on the wheel angle (rad), the same in both directions of motion."""
    return p.ripple * np.cos(p.cycles * angle + p.ripple_phase) if "ripple" in p.features else 0.0
