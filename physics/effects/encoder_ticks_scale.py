"""Encoders with other than the believed counts per revolution."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale, Plausible


class EncoderTicksScale(Effect):
    slot = Slot.ENCODER
    cause = "another gear ratio or code wheel"
    excitation = "speeds and distances that are known otherwise"
    setups = (Setup.DRIVE,)

    scale: Annotated[GeometryScale, Plausible(0.5, 2.0, "one edge counted for two, or two for one")]
    """True ticks per revolution = scale * nominal."""

    def apply(self, counts_per_revolution: float) -> float:
        return self.scale * counts_per_revolution
