"""An error that grows with the logarithm of the distance (paper Eq. 24)."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.logarithmic_error import log_beyond_near
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class LogRangeError(Effect):
    """The error grows with the logarithm of the distance beyond 0.18 m (paper Eq. 24)."""

    slot = Slot.RANGE
    cause = "nonlinearity of the timing circuit"
    excitation = "distances below and above 0.18 m"
    setups = (Setup.RANGE_BENCH,)

    coefficient_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-0.3, high=0.3)]
    """reading + coefficient * ln(distance / 0.18 m) beyond 0.18 m."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.coefficient_m * log_beyond_near(view.distance_m)
