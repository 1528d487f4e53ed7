"""Noise that grows with the ambient light."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class AmbientNoise(Effect):
    """The variance of the noise grows linearly with the ambient light."""

    slot = Slot.RANGE_NOISE
    cause = "sunlight and lamps in the near infrared"
    excitation = "many readings under weak and strong light"
    setups = (Setup.RANGE_BENCH,)

    coefficient_per_klux: Annotated[float, Parameter("1/klux", null=0.0, start=0.3, low=0.0, high=100.0)]
    """Variance of the noise * (1 + coefficient * ambient light / 1000 lux)."""

    def apply(self, sd_m: Array, view: RangeView) -> Array:
        # Only the factor has a root, so that without light or effect it is exactly one.
        return sd_m * np.sqrt(1.0 + self.coefficient_per_klux * view.ambient_lux / 1000.0)
