"""One channel of the line sensor that reads too much or too little by the same amount."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.line.line_channels import CHANNELS, ChannelName
from symolo.core.arrays import Array


class LineOffset(Effect):
    """The reading of one channel is too large or too small by a constant."""

    slot = Slot.LINE_READING
    cause = "leakage current, light that leaks from the emitter to the receiver"
    excitation = "line and bare floor under that channel"
    setups = (Setup.LINE_LOG,)

    channel: ChannelName
    """Channel with this offset."""
    offset: Annotated[float, Parameter("1", null=0.0, start=0.05, low=-0.5, high=0.5)]
    """Reading of that channel + offset; 1 is full scale."""

    def apply(self, reading: Array) -> Array:
        return reading + np.where(self.channel == CHANNELS, self.offset, 0.0)
