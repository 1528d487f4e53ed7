"""A measured speed that is low-pass filtered."""

from configs.schema.terms.motor import SpeedFilterLag
from physics.first_order import followed
from physics.terms.base import Slot, Term
from sensors.base import Array


def filtered(
    values: SpeedFilterLag, held_rad_s: Array, before_rad_s: Array, speed_rad_s: Array, duration_s: float
) -> Array:
    return followed(held_rad_s, before_rad_s, speed_rad_s, duration_s, values.time_constant_s)


TERM = Term(
    SpeedFilterLag,
    Slot.SPEED_FILTER,
    cause="smoothing of the encoder's quantised speed",
    excitation="steps of voltage: the speed lags what the current says",
    apply=filtered,
)
