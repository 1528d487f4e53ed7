"""A gearbox with play: motor side and load side, at the wheel shaft, that push each other at the ends of the gap."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TwoMass:
    motor_rad_s: Array
    load_rad_s: Array
    slack_rad: Array
    """Angle of the motor side ahead of mid-gap."""


@dataclass(frozen=True)
class Load:
    """What acts on a mass, and its inertia."""

    torque_N_m: Array
    """At rest."""
    damping_N_m_s_rad: Array
    friction_N_m: Array
    inertia_kg_m2: Array

    def moved(self, speed_rad_s: Array, duration_s: float) -> Array:
        """Speed after a short step, damping taken at its end; friction stops a mass and never turns it round."""
        heavier = self.inertia_kg_m2 + duration_s * self.damping_N_m_s_rad
        free: Array = (self.inertia_kg_m2 * speed_rad_s + duration_s * self.torque_N_m) / heavier
        grip: Array = duration_s * self.friction_N_m / heavier
        return np.copysign(np.maximum(np.abs(free) - grip, 0.0), free)

    def __add__(self, other: "Load") -> "Load":
        """Both as one mass."""
        return Load(
            self.torque_N_m + other.torque_N_m,
            self.damping_N_m_s_rad + other.damping_N_m_s_rad,
            self.friction_N_m + other.friction_N_m,
            self.inertia_kg_m2 + other.inertia_kg_m2,
        )
