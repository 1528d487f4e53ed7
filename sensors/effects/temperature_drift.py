"""Ranges that follow the temperature."""

from configs.schema.effects.range_bench import TemperatureDrift
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def drifted(values: TemperatureDrift, reading_m: Array, view: RangeView) -> Array:
    return reading_m + values.coefficient_m_per_K * (view.temperature_C - view.reference_temperature_C)


TERM = Term(
    TemperatureDrift,
    Slot.RANGE,
    cause="timing circuit without temperature compensation",
    excitation="temperatures well apart at the same distance",
    apply=drifted,
)
