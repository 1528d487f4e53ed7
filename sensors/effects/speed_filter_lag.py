"""A measured speed that is low-pass filtered."""

from configs.schema.effects.motor import SpeedFilterLag
from physics.drivetrain.first_order import followed
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


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
