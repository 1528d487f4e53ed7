"""Ranges that are longer on one side of a tilt than on the other."""

from typing import Annotated, Literal

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class TiltAsymmetry(Effect):
    """A reading becomes longer when the sensor is tilted to one side, and shorter when it is tilted to the other."""

    slot = Slot.RANGE
    cause = "emitter and receiver side by side, and tolerances of their mounting"
    excitation = "tilts to both sides about one axis, at the same distance"
    setups = (Setup.RANGE_BENCH,)

    axis: Literal["forward", "sideways"]
    """Direction of the tilt."""
    coefficient_m_per_rad: Annotated[float, Parameter("m/rad", null=0.0, start=0.02, low=-0.5, high=0.5)]
    """reading + coefficient * tilt: of the sensor's axis up (`forward`) or to the left (`sideways`)."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        tilt = view.tilt_forward_rad if self.axis == "forward" else view.tilt_sideways_rad
        return reading_m + self.coefficient_m_per_rad * tilt
