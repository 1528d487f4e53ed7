"""A speed that is computed with the wrong counts per revolution."""

from configs.schema.effects.motor import SpeedScale
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def scaled(values: SpeedScale, speed_rad_s: Array) -> Array:
    return values.scale * speed_rad_s


TERM = Term(
    SpeedScale,
    Slot.SPEED_READING,
    cause="another code wheel or gear ratio",
    excitation="a wide range of speeds, and the current",
    apply=scaled,
)
