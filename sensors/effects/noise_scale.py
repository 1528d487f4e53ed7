"""More or less noise than nominal."""

from configs.schema.effects.range_bench import NoiseScale
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def scaled(values: NoiseScale, sd_m: Array, _view: RangeView) -> Array:
    return values.scale * sd_m


TERM = Term(
    NoiseScale,
    Slot.RANGE_NOISE,
    cause="timing budget, supply noise",
    excitation="many readings of the same target",
    apply=scaled,
)
