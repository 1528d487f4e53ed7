"""Turns that are smaller than those of the wheels, by a share that grows with the lateral force."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class TurnSlip(Effect):
    """The robot turns less than its wheels do, the more so the larger the lateral acceleration v * yaw rate is."""

    slot = Slot.GROUND
    cause = "tyres that creep under lateral force"
    excitation = "arcs at several speeds and curvatures"
    setups = (Setup.DRIVE,)

    coefficient_s2_m: Annotated[float, Parameter("s2/m", null=0.0, start=0.5, low=0.0, high=20.0)]
    """dtheta = dtheta_kinematic / (1 + coefficient * |v * yaw rate|), with v and yaw rate of the wheels."""

    def apply(self, share: Array, speed_m_s: Array, yaw_rate_rad_s: Array) -> Array:
        return share / (1.0 + self.coefficient_s2_m * np.abs(speed_m_s * yaw_rate_rad_s))
