"""The H-bridge between supply and windings."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array


@dataclass(frozen=True)
class Chopper:
    """One winding per motor, whose voltage the bridge switches on and off; motors along the last axis."""

    no_load_V: float | Array
    """Supply voltage without load, at this time."""
    duty: Array
    """Signed duty cycle of each motor."""
    resistance_ohm: Array
    """Resistance of each winding."""
    back_emf_V: Array
    """K w of each motor."""

    def supply_V(self, emf_V: Array) -> Array:
        """Return the supply voltage that belongs to u - K w [V] with u = duty * supply."""
        size = np.abs(self.duty)
        full_V = np.full(emf_V.shape, self.no_load_V)
        return np.divide(np.abs(emf_V + self.back_emf_V), size, out=full_V, where=size > 0.0)


@dataclass(frozen=True)
class Bridge:
    """One supply with its windings; motors along the last axis."""

    supply_V: float | Array
    """Supply voltage without load, at this time."""
    duty: Array
    """Signed duty cycle of each motor."""
    resistance_ohm: Array
    """Resistance of each winding."""
    driving_V: Callable[[Array], Array]
    """Function from u - K w [V] to the part of it that remains after the transistors [V]."""

    def current_A(self, emf_V: Array) -> Array:
        """Return the winding currents at u - K w [V]."""
        return self.driving_V(emf_V) / self.resistance_ohm
