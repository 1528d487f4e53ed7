"""Light that comes back from a cover glass and pulls readings down."""

from configs.schema.effects.range_bench import CoverCrosstalk
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def pulled(values: CoverCrosstalk, reading_m: Array, view: RangeView) -> Array:
    return reading_m / (1.0 + values.strength_per_m2 * view.distance_m**2 / view.reflectance)


TERM = Term(
    CoverCrosstalk,
    Slot.RANGE,
    cause="a dirty or badly spaced cover glass",
    excitation="dark and light targets far away",
    apply=pulled,
)
