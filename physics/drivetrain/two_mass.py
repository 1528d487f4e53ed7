"""A gearbox with play: motor side and load side, at the wheel shaft, push each other at the ends of the gap."""

from dataclasses import dataclass

import numpy as np

from physics.drivetrain.motor_arrays import HeldDrive
from symolo.core.arrays import Array

MIN_DAMPING_N_M_S_RAD = 1e-12
"""Replaces a damping of 0, which would divide by zero."""


@dataclass(frozen=True)
class TwoMass:
    """Speeds of both sides of a gearbox and their relative angle; arrays of the same shape."""

    motor_rad_s: Array
    """Speed of the motor side, as at the wheel shaft."""
    load_rad_s: Array
    """Speed of the wheel."""
    slack_rad: Array
    """Angle of the motor side ahead of mid-gap."""


@dataclass(frozen=True)
class Load:
    """Torques on a mass, and its inertia."""

    torque_N_m: Array
    """Torque at rest."""
    damping_N_m_s_rad: Array
    """Fall of the torque per speed."""
    friction_N_m: Array
    """Torque of the dry friction against the motion."""
    inertia_kg_m2: Array
    """Inertia of the mass."""

    def moved(self, speed_rad_s: Array, duration_s: float | Array) -> tuple[Array, Array]:
        """Return speed [rad/s] after a time and turned angle [rad]; exact, through a stop and a start."""
        damping = np.maximum(self.damping_N_m_s_rad, MIN_DAMPING_N_M_S_RAD)
        held = HeldDrive(self.torque_N_m, damping, self.friction_N_m, self.inertia_kg_m2)
        return held.step(speed_rad_s, duration_s)

    def __add__(self, other: "Load") -> "Load":
        """Return both as one mass."""
        return Load(
            self.torque_N_m + other.torque_N_m,
            self.damping_N_m_s_rad + other.damping_N_m_s_rad,
            self.friction_N_m + other.friction_N_m,
            self.inertia_kg_m2 + other.inertia_kg_m2,
        )
