"""Ranges that change with the angle at which the target is met."""

import numpy as np

from configs.schema.effects.range_bench import IncidenceBias
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def tilted(values: IncidenceBias, reading_m: Array, view: RangeView) -> Array:
    return reading_m + values.coefficient * view.distance_m * np.sin(view.incidence_rad) ** 2


TERM = Term(
    IncidenceBias,
    Slot.RANGE,
    cause="a footprint that lies over near and far parts of the target",
    excitation="several angles at the same distance",
    apply=tilted,
)
