"""Friction that falls when motion sets in."""

import numpy as np

from configs.schema.effects.motor import StribeckFriction
from physics.drivetrain.motion import Motion
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def raised(values: StribeckFriction, friction_N_m: Array, motion: Motion) -> Array:
    falling = np.exp(-((motion.speed_rad_s / values.stribeck_speed_rad_s) ** 2))
    return friction_N_m + values.extra_torque_N_m * falling


TERM = Term(
    StribeckFriction,
    Slot.FRICTION,
    cause="boundary lubrication in gears and bearings",
    excitation="slow speeds, and breakaway from rest",
    apply=raised,
)
