"""More or less noise than nominal."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Scale
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class NoiseScale(Effect):
    """The standard deviation of the noise is a multiple of the nominal one."""

    slot = Slot.RANGE_NOISE
    cause = "timing budget, supply noise"
    excitation = "many readings of the same target"
    setups = (Setup.RANGE_BENCH,)

    scale: Scale
    """Standard deviation of the noise * scale."""

    def apply(self, sd_m: Array, _view: RangeView) -> Array:
        return self.scale * sd_m
