"""A current sensor that does not read zero at zero."""

from configs.schema.effects.motor import CurrentSensorOffset
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def shifted(values: CurrentSensorOffset, current_A: Array) -> Array:
    return current_A + values.offset_A


TERM = Term(
    CurrentSensorOffset,
    Slot.CURRENT_READING,
    cause="offset of amplifier or converter",
    excitation="rest at 0 V, both signs of the current",
    apply=shifted,
)
