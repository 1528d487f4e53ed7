"""Ranges that are wrong close by."""

import numpy as np

from configs.schema.effects.range_bench import NearFieldError
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def raised(values: NearFieldError, reading_m: Array, view: RangeView) -> Array:
    return reading_m + values.amplitude_m * np.exp(-view.distance_m / values.decay_length_m)


TERM = Term(
    NearFieldError,
    Slot.RANGE,
    cause="parallax of emitter and receiver, saturation by strong echoes",
    excitation="distances of a few centimetres",
    apply=raised,
)
