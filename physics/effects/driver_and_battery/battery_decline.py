"""A battery that runs down."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class BatteryDecline(Effect):
    """The voltage of the battery falls linearly with the time since the start of the session."""

    slot = Slot.BATTERY
    cause = "discharge under a driver that does not regulate"
    excitation = "the same commands early and late in the session"
    setups = (Setup.DRIVE,)
    grows_with_time = True

    fraction_per_minute: Annotated[float, Parameter("1/min", null=0.0, start=0.03, low=0.0, high=1.0)]
    """u_true = u (1 - fraction * time / 60 s), and 0 when the battery is empty."""

    def apply(self, voltage_V: Array, time_s: float | Array) -> Array:
        """Return the voltage, which falls linearly to 0 V."""
        return voltage_V * np.maximum(1.0 - self.fraction_per_minute * time_s / 60.0, 0.0)
