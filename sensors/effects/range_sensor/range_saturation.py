"""Ranges that never exceed a limit."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class RangeSaturation(Effect):
    """No reading is longer than a limit."""

    slot = Slot.RANGE_LIMIT
    cause = "timing budget or range profile of the device"
    excitation = "targets at large distances"
    setups = (Setup.RANGE_BENCH,)

    saturation_m: Annotated[float, Parameter("m", null=100.0, start=0.5, low=0.05, high=100.0)]
    """reading <= saturation; the upper bound means no limit."""

    def apply(self, reading_m: Array) -> Array:
        return np.minimum(reading_m, self.saturation_m)
