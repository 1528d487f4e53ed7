"""A driver that limits its current."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class CurrentLimit(Effect):
    """The driver limits the current of each motor, in both directions."""

    slot = Slot.CURRENT_LIMIT
    cause = "protection of the bridge"
    excitation = "hard starts and reversals"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    limit_A: Annotated[float, Parameter("A", null=1000.0, start=0.8, low=0.01, high=1000.0)]
    """|I| <= limit; the upper bound means no limit."""

    def apply(self, current_A: Array) -> Array:
        return np.minimum(np.maximum(current_A, -self.limit_A), self.limit_A)
