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
class SideLoads:
    """What acts on each side, and its inertia."""

    drive_N_m: Array
    """On the motor side, at rest."""
    motor_damping_N_m_s_rad: Array
    load_damping_N_m_s_rad: Array
    motor_friction_N_m: Array
    load_friction_N_m: Array
    motor_inertia_kg_m2: Array
    load_inertia_kg_m2: Array


def slowed(speed: Array, torque: Array, damping: Array, friction: Array, inertia: Array, duration_s: float) -> Array:
    """Speed after a short step, damping taken at its end; friction stops a mass and never turns it round."""
    free = (speed + duration_s * torque / inertia) / (1.0 + duration_s * damping / inertia)
    grip = duration_s * friction / inertia / (1.0 + duration_s * damping / inertia)
    return np.sign(free) * np.maximum(np.abs(free) - grip, 0.0)
