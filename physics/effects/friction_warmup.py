"""Friction that changes while the gearbox warms up."""

import numpy as np

from configs.schema.effects.motor import FrictionWarmup
from physics.drivetrain.motion import Motion
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def warming(values: FrictionWarmup, friction_N_m: Array, motion: Motion) -> Array:
    return friction_N_m * (1.0 + values.amplitude * np.exp(-motion.time_s / values.time_constant_s))


TERM = Term(
    FrictionWarmup,
    Slot.FRICTION,
    cause="cold grease",
    excitation="the same voltages early and late in the session",
    apply=warming,
)
