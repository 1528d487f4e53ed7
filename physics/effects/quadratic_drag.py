"""Drag that grows with the square of the speed."""

from configs.schema.effects.motor import QuadraticDrag
from physics.drivetrain.motion import Motion
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def raised(values: QuadraticDrag, friction_N_m: Array, motion: Motion) -> Array:
    return friction_N_m + values.coefficient_N_m_s2_rad2 * motion.speed_rad_s**2


TERM = Term(
    QuadraticDrag,
    Slot.FRICTION,
    cause="churning grease, a fan on the shaft",
    excitation="current against speed up to the highest speed",
    apply=raised,
)
