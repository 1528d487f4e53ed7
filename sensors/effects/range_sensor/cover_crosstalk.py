"""Light that a cover glass sends back, which makes readings too short."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class CoverCrosstalk(Effect):
    """A reading is the mean distance of the target and of the cover glass, weighted by the light that both return.

    The target at the distance d returns reflectance / d^2, and the glass a constant amount from the distance 0. The
    mean is d / (1 + strength d^2 / reflectance).
    """

    slot = Slot.RANGE
    cause = "a cover glass that is dirty or at a wrong distance"
    excitation = "dark and light targets at large distances"
    setups = (Setup.RANGE_BENCH,)

    strength_per_m2: Annotated[float, Parameter("1/m2", null=0.0, start=0.05, low=0.0, high=10.0)]
    """reading = distance / (1 + strength * distance^2 / reflectance)."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m / (1.0 + self.strength_per_m2 * view.distance_m**2 / view.reflectance)
