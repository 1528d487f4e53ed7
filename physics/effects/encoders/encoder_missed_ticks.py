"""An encoder that loses counts at speed."""

from typing import Annotated, Literal

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array

SIDES = np.array(["right", "left"])
EDGE_RAD_S = 0.3
"""Width of the logistic threshold, at which half of the loss is reached."""


class EncoderMissedTicks(Effect):
    """One encoder loses a fraction of its counts while its wheel is faster than a threshold."""

    slot = Slot.COUNTING
    cause = "a weak or misaligned sensor, an interrupt routine that is too slow"
    excitation = "slow and fast drives of the same length"
    setups = (Setup.DRIVE,)

    side: Literal["left", "right"]
    """Wheel whose encoder loses counts."""
    fraction: Annotated[float, Parameter("1", null=0.0, start=0.1, low=0.0, high=1.0)]
    """Fraction of its ticks that this side loses above the threshold, which is smooth over 0.3 rad/s."""
    threshold_rad_s: Annotated[float, Parameter("rad/s", null=None, start=3.0, low=0.0, high=100.0)]
    """Speed of the wheel at which the encoder loses half of that fraction."""

    def apply(self, turned_rad: Array, duration_s: float) -> Array:
        speed_rad_s = np.abs(turned_rad) / duration_s
        beyond = np.clip((speed_rad_s - self.threshold_rad_s) / EDGE_RAD_S, -40.0, 40.0)
        lost = self.fraction / (1.0 + np.exp(-beyond))
        return turned_rad * np.where(self.side == SIDES, 1.0 - lost, 1.0)
