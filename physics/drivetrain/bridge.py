"""The H-bridge between supply and windings."""

from collections.abc import Callable
from dataclasses import dataclass

from symolo.core.arrays import Array


@dataclass(frozen=True)
class Bridge:
    """One supply with its windings; motors along the last axis."""

    supply_V: float
    """Supply voltage without load."""
    duty: Array
    """Signed duty cycle of each motor."""
    resistance_ohm: Array
    """Resistance of each winding."""
    driving_V: Callable[[Array], Array]
    """Function from u - K w [V] to the part of it that remains after the transistors [V]."""

    def current_A(self, emf_V: Array) -> Array:
        """Return the winding currents at u - K w [V]."""
        return self.driving_V(emf_V) / self.resistance_ohm
