"""Friction that changes while the gearbox warms up."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import DriftTime, Parameter
from physics.drivetrain.motion import ShaftMotion
from symolo.core.arrays import Array


class FrictionWarmup(Effect):
    """The Coulomb friction Tc approaches its nominal value exponentially after the motor was switched on."""

    slot = Slot.FRICTION
    cause = "cold grease"
    excitation = "the same voltages early and late in the session"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    amplitude: Annotated[float, Parameter("1", null=0.0, start=0.3, low=-0.9, high=5.0)]
    """Tc (1 + amplitude * exp(-t / time_constant)), t since the motor was first switched on."""
    time_constant_s: DriftTime
    """Time after which 37 % of the initial deviation is left."""

    def apply(self, friction_N_m: Array, motion: ShaftMotion) -> Array:
        return friction_N_m * (1.0 + self.amplitude * np.exp(-motion.time_s / self.time_constant_s))
