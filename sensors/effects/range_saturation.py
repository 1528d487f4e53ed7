"""Ranges that never exceed a limit."""

import numpy as np

from configs.schema.effects.range_bench import RangeSaturation
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def saturated(values: RangeSaturation, reading_m: Array) -> Array:
    return np.minimum(reading_m, values.saturation_m)


TERM = Term(
    RangeSaturation,
    Slot.RANGE_LIMIT,
    cause="timing budget or range profile of the device",
    excitation="targets far away",
    apply=saturated,
)
