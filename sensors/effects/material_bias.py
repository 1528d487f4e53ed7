"""One material that is read too far or too near."""

import numpy as np

from configs.schema.effects.range_bench import MaterialBias
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def biased(values: MaterialBias, reading_m: Array, view: RangeView) -> Array:
    share = view.material_share.get(values.material, np.zeros_like(reading_m))
    return reading_m + values.offset_m * share


TERM = Term(
    MaterialBias,
    Slot.RANGE,
    cause="light that enters a surface before it returns, shape of the pulse",
    excitation="several materials at the same distance",
    apply=biased,
)
