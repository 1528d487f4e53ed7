"""The H-bridge between supply and windings."""

from collections.abc import Callable
from dataclasses import dataclass

from symolo.core.arrays import Array


@dataclass(frozen=True)
class Bridge:
    """Motors along the last axis."""

    supply_V: float
    """Off load."""
    duty: Array
    """With its sign."""
    resistance_ohm: Array
    """Of the windings."""
    driving_V: Callable[[Array], Array]
    """What is left of u - K w behind the transistors."""

    def current_A(self, emf_V: Array) -> Array:
        """Through the windings at this u - K w [V]."""
        return self.driving_V(emf_V) / self.resistance_ohm
