"""Ranges that drift after power-on."""

import numpy as np

from configs.schema.effects.range_bench import WarmupDrift
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def warming(values: WarmupDrift, reading_m: Array, view: RangeView) -> Array:
    return reading_m + values.amplitude_m * np.exp(-view.time_s / values.time_constant_s)


TERM = Term(
    WarmupDrift,
    Slot.RANGE,
    cause="self-heating of the device",
    excitation="the same distance from power-on until it has settled",
    apply=warming,
)
