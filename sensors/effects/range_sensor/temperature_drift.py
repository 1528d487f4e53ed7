"""Ranges that drift with the temperature."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class TemperatureDrift(Effect):
    """The error of a reading is proportional to the difference from the reference temperature."""

    slot = Slot.RANGE
    cause = "timing circuit without temperature compensation"
    excitation = "very different temperatures at the same distance"
    setups = (Setup.RANGE_BENCH,)

    coefficient_m_per_K: Annotated[float, Parameter("m/K", null=0.0, start=6e-4, low=-0.01, high=0.01)]
    """reading + coefficient * (temperature - reference temperature)."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.coefficient_m_per_K * (view.temperature_C - view.reference_temperature_C)
