"""Friction that is not the same forward and in reverse."""

from configs.schema.effects.motor import FrictionAsymmetry
from physics.drivetrain.motion import Motion
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def one_sided(values: FrictionAsymmetry, friction_N_m: Array, motion: Motion) -> Array:
    return friction_N_m * (1.0 - values.asymmetry * motion.direction)


TERM = Term(
    FrictionAsymmetry,
    Slot.FRICTION,
    cause="axial load on worm or helical gears, brushes set at an angle",
    excitation="both directions of rotation",
    apply=one_sided,
)
