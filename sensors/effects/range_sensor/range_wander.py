"""Ranges with a slow random drift (first-order Gauss-Markov process)."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import DriftTime, Parameter
from symolo.core.arrays import Array


class RangeWander(Effect):
    """Readings have a slow random error, a first-order Gauss-Markov process that is as large at all times."""

    slot = Slot.RANGE_WANDER
    cause = "temperature and reference voltage of the device, which drift slowly"
    excitation = "a target at rest or a drive between walls, for many times the time constant"
    setups = (Setup.RANGE_BENCH, Setup.DRIVE)

    sd_m: Annotated[float, Parameter("m", null=0.0, start=0.002, low=0.0, high=0.1)]
    """reading + first-order Gauss-Markov error of this standard deviation and time constant."""
    time_constant_s: DriftTime
    """Time after which the correlation of the error has fallen to 37 %."""

    def apply(self, error_m: Array, duration_s: float, deviates: Array) -> Array:
        remaining = np.exp(-duration_s / self.time_constant_s)
        return remaining * error_m + self.sd_m * np.sqrt(1.0 - remaining**2) * deviates
