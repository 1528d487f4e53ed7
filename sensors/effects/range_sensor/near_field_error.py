"""Ranges that are wrong at short distances."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class NearFieldError(Effect):
    """Readings of near targets have an error that decays exponentially with the distance."""

    slot = Slot.RANGE
    cause = "parallax of emitter and receiver, saturation by strong echoes"
    excitation = "distances of a few centimetres"
    setups = (Setup.RANGE_BENCH,)

    amplitude_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-0.2, high=0.2)]
    """reading + amplitude * exp(-distance / decay_length)."""
    decay_length_m: Annotated[float, Parameter("m", null=None, start=0.08, low=0.005, high=2.0)]
    """Distance over which the error falls to 37 %."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.amplitude_m * np.exp(-view.distance_m / self.decay_length_m)
