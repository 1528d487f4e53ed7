"""A speed that is computed with the wrong counts per revolution."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Plausible, Scale
from symolo.core.arrays import Array


class SpeedScale(Effect):
    """The measured speed is a multiple of the true speed."""

    slot = Slot.SPEED_READING
    cause = "a different code wheel or gear ratio"
    excitation = "a wide range of speeds, compared with the current"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    scale: Annotated[
        Scale,
        Plausible(
            0.25, 4.0, "a code wheel read at one edge instead of four, or the reverse; other gear ratios are in between"
        ),
    ]
    """measured speed = scale * true speed, because of wrong counts per revolution."""

    def apply(self, speed_rad_s: Array) -> Array:
        return self.scale * speed_rad_s
