"""One channel of the line sensor that is too sensitive or too dull."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.line.line_channels import CHANNELS, ChannelName
from symolo.core.arrays import Array


class LineGain(Effect):
    """One channel is more or less sensitive than the others."""

    slot = Slot.LINE_READING
    cause = "an aged or dirty photodiode, another resistor"
    excitation = "line and bare floor under that channel"
    setups = (Setup.LINE_LOG,)

    channel: ChannelName
    """Channel with this gain."""
    scale: Annotated[float, Parameter("1", null=1.0, start=1.15, low=0.05, high=5.0)]
    """Reflectance above black of that channel * scale."""

    def apply(self, reading: Array) -> Array:
        return reading * np.where(self.channel == CHANNELS, self.scale, 1.0)
