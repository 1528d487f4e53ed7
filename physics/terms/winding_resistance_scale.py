"""Winding resistance other than nominal."""

from dataclasses import replace

from configs.schema.terms.motor import WindingResistanceScale
from physics.motor import Motors
from physics.terms.base import Slot, Term


def scaled(values: WindingResistanceScale, motors: Motors) -> Motors:
    return motors.each(lambda motor: replace(motor, resistance_ohm=values.scale * motor.resistance_ohm))


TERM = Term(
    WindingResistanceScale,
    Slot.MOTORS,
    cause="another winding, brushes and contacts, a warm winding",
    excitation="stall and low speed: current against voltage",
    apply=scaled,
)
