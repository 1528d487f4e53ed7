"""Friction that falls when motion begins."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from physics.drivetrain.motion import ShaftMotion
from symolo.core.arrays import Array


class StribeckFriction(Effect):
    """The friction is larger at rest than in motion, and falls with a Gaussian curve of the speed w.

    The law is described by Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30 (1994) 1083-1138.
    """

    slot = Slot.FRICTION
    cause = "boundary lubrication in gears and bearings"
    excitation = "slow speeds, and breakaway from rest"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    extra_torque_N_m: Annotated[float, Parameter("N m", null=0.0, start=0.008, low=0.0, high=20.0)]
    """Friction + extra_torque * exp(-(w / stribeck_speed)^2), against the motion; breakaway at Tc + extra_torque."""
    stribeck_speed_rad_s: Annotated[
        float, Parameter("rad/s", null=None, start=2.0, low=0.05, high=2000.0, fit_high=50.0)
    ]
    """Speed at which 37 % of the extra torque is left."""

    def apply(self, friction_N_m: Array, motion: ShaftMotion) -> Array:
        falling = np.exp(-((motion.speed_rad_s / self.stribeck_speed_rad_s) ** 2))
        return friction_N_m + self.extra_torque_N_m * falling
