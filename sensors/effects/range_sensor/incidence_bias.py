"""Ranges whose error depends on the angle of incidence."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class IncidenceBias(Effect):
    """Readings are too long or too short on surfaces that the beam hits at an angle, in proportion to the distance."""

    slot = Slot.RANGE
    cause = "a light spot that covers near and far parts of the target"
    excitation = "several angles at the same distance"
    setups = (Setup.RANGE_BENCH,)

    coefficient: Annotated[float, Parameter("1", null=0.0, start=0.08, low=-2.0, high=2.0)]
    """reading + coefficient * distance * sin^2(incidence)."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.coefficient * view.distance_m * np.sin(view.incidence_rad) ** 2
