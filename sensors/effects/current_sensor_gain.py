"""A current sensor with another gain."""

from configs.schema.effects.motor import CurrentSensorGain
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def amplified(values: CurrentSensorGain, current_A: Array) -> Array:
    return values.gain * current_A


TERM = Term(
    CurrentSensorGain,
    Slot.CURRENT_READING,
    cause="tolerance of shunt and amplifier",
    excitation="a wide range of currents; with speed, since alone it is a resistance and a friction",
    apply=amplified,
)
