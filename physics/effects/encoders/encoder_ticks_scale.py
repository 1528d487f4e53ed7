"""Encoders whose counts per revolution are not nominal."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale, Plausible


class EncoderTicksScale(Effect):
    """Both encoders count more or fewer ticks per revolution than the description of the robot states."""

    slot = Slot.ENCODER
    cause = "a different gear ratio or code wheel"
    excitation = "speeds and distances that are known from another source"
    setups = (Setup.DRIVE,)

    scale: Annotated[GeometryScale, Plausible(0.5, 2.0, "one edge counted instead of two, or two instead of one")]
    """True ticks per revolution = scale * nominal."""

    def apply(self, counts_per_revolution: float) -> float:
        return self.scale * counts_per_revolution
