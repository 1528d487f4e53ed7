"""Near parts of a scene that outshine far ones in the mean of a range sensor."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array

CONTACT_M = 1e-3
"""Distance below which a ray counts as this long, so that its weight is finite."""


class RangeSignalWeighting(Effect):
    """Near parts of a scene have more weight in the mean over the beam, because more of their light returns."""

    slot = Slot.RAY_WEIGHT
    cause = "light that falls off with the square of the distance"
    excitation = "edges, steps and curved surfaces, where the beam covers near and far parts"
    setups = (Setup.RANGE_SCAN,)

    exponent: Annotated[float, Parameter("1", null=0.0, start=2.0, low=0.0, high=6.0)]
    """weight of a ray / distance^exponent, besides the beam profile and Lambert's law."""

    def apply(self, weight: Array, distance_m: Array) -> Array:
        return weight * np.maximum(distance_m, CONTACT_M) ** -self.exponent
