"""Light that comes back from a cover glass and pulls readings down."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.range_view import RangeView
from symolo.core.arrays import Array


class CoverCrosstalk(Effect):
    slot = Slot.RANGE
    cause = "a dirty or badly spaced cover glass"
    excitation = "dark and light targets far away"
    setups = (Setup.RANGE_BENCH,)

    strength_per_m2: Annotated[float, Parameter("1/m2", null=0.0, start=0.05, low=0.0, high=10.0)]
    """reading = distance / (1 + strength * distance^2 / reflectance)."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m / (1.0 + self.strength_per_m2 * view.distance_m**2 / view.reflectance)
