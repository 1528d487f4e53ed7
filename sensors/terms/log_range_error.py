"""An error that grows with the logarithm of the distance (paper Eq. 24)."""

import numpy as np

from configs.schema.terms.range_bench import LogRangeError
from physics.terms.base import Slot, Term
from sensors.base import Array
from sensors.range_view import RangeView

ORIGIN_M = 0.18
"""Below it there is none (paper section 5.2.2)."""


def bent(values: LogRangeError, reading_m: Array, view: RangeView) -> Array:
    return reading_m + values.coefficient_m * np.log(np.maximum(view.distance_m, ORIGIN_M) / ORIGIN_M)


TERM = Term(
    LogRangeError,
    Slot.RANGE,
    cause="nonlinearity of the timing circuit",
    excitation="distances below and beyond 0.18 m",
    apply=bent,
)
