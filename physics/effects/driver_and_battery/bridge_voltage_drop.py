"""Voltage that is lost in the transistors of the bridge."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter, Plausible
from symolo.core.arrays import Array


class BridgeVoltageDrop(Effect):
    """The transistors of the bridge lose a constant voltage, so that small voltages drive no current."""

    slot = Slot.BRIDGE
    cause = "saturation voltage of bipolar bridges, body diodes"
    excitation = "low voltages of both signs, and current at rest"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    drop_V: Annotated[
        float,
        Parameter("V", null=0.0, start=0.3, low=0.0, high=20.0),
        Plausible(
            0.0, 5.0, "by the data sheet of the L298, both transistors lose 1.8 V at 1 A and at most 4.9 V at 2 A"
        ),
    ]
    """Voltage lost in the bridge, against the current: I = sgn(e) max(|e| - drop, 0) / R with e = u - K w."""

    def apply(self, emf_V: Array) -> Array:
        return np.copysign(np.maximum(np.abs(emf_V) - self.drop_V, 0.0), emf_V)
