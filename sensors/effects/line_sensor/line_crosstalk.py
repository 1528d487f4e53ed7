"""Channels of the line sensor that see light of their neighbours."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class LineCrosstalk(Effect):
    """Each channel receives a part of its light from the spots of its neighbours, which blurs the edges of the line."""

    slot = Slot.LINE_READING
    cause = "emitters that also light the spots of the neighbouring receivers"
    excitation = "the edges of the line"
    setups = (Setup.LINE_LOG,)

    share: Annotated[float, Parameter("1", null=0.0, start=0.05, low=0.0, high=0.33)]
    """Share of the reading of each neighbour that a channel takes in place of its own."""

    def apply(self, reading: Array) -> Array:
        """Return the readings (..., 8), each mixed with those beside it; the outer channels have one neighbour."""
        step = self.share * np.diff(reading, axis=-1)
        nothing = np.zeros_like(step[..., :1])
        return reading + np.concatenate([step, nothing], axis=-1) - np.concatenate([nothing, step], axis=-1)
