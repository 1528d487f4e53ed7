"""Readings of the line sensor that stop short of the ends of the scale."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from configs.validation.faults import ConfigFault
from symolo.core.arrays import Array


class LineAdcSaturation(Effect):
    """The converter of the line sensor clips all readings, so that line and bare floor do not reach the ends of the
    scale.
    """

    slot = Slot.LINE_LIMIT
    cause = "a converter whose range is smaller than that of the signal"
    excitation = "line and bare floor"
    setups = (Setup.LINE_LOG,)

    low: Annotated[float, Parameter("1", null=0.0, start=0.1, low=0.0, high=0.5, is_floor=True)]
    """Smallest reading."""
    high: Annotated[float, Parameter("1", null=1.0, start=0.8, low=0.3, high=1.0)]
    """Largest reading: readings are clipped to [low, high]."""

    def apply(self, reading: Array) -> Array:
        return np.minimum(np.maximum(reading, self.low), self.high)

    def faults(self, *, in_simulation: bool) -> Iterator[ConfigFault]:
        del in_simulation
        if self.low >= self.high:
            allowed = f"less than high, which is {self.high}"
            yield ConfigFault(("low",), got=self.low, allowed=allowed, against=("high",))
