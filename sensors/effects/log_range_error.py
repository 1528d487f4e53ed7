"""An error that grows with the logarithm of the distance (paper Eq. 24)."""

from configs.schema.effects.range_bench import LogRangeError
from physics.effects.base import Slot, Term
from sensors.range_log import log_beyond_near
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def bent(values: LogRangeError, reading_m: Array, view: RangeView) -> Array:
    return reading_m + values.coefficient_m * log_beyond_near(view.distance_m)


TERM = Term(
    LogRangeError,
    Slot.RANGE,
    cause="nonlinearity of the timing circuit",
    excitation="distances below and beyond 0.18 m",
    apply=bent,
)
