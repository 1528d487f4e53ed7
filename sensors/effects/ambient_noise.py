"""Noise that grows with the light around."""

import numpy as np

from configs.schema.effects.range_bench import AmbientNoise
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def lit(values: AmbientNoise, sd_m: Array, view: RangeView) -> Array:
    # The factor on the variance under its own root: without light or effect it is one to the bit.
    return sd_m * np.sqrt(1.0 + values.coefficient_per_klux * view.ambient_lux / 1000.0)


TERM = Term(
    AmbientNoise,
    Slot.RANGE_NOISE,
    cause="sunlight and lamps in the near infrared",
    excitation="many readings under weak and strong light",
    apply=lit,
)
