"""Ranges that drift after power-on."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import DriftTime, Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class WarmupDrift(Effect):
    """All readings have an error that decays exponentially after the sensor was switched on."""

    slot = Slot.RANGE
    cause = "self-heating of the device"
    excitation = "the same distance, from power-on until the reading has settled"
    setups = (Setup.RANGE_BENCH,)

    amplitude_m: Annotated[float, Parameter("m", null=0.0, start=0.01, low=-0.2, high=0.2)]
    """reading + amplitude * exp(-t / time_constant), t since power-on."""
    time_constant_s: DriftTime
    """Time after which 37 % of the initial error is left."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.amplitude_m * np.exp(-view.time_s / self.time_constant_s)
