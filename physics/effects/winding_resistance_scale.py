"""Winding resistance other than nominal."""

from dataclasses import replace

from configs.schema.effects.motor import WindingResistanceScale
from physics.drivetrain.motor import Motors
from physics.effects.base import Slot, Term


def scaled(values: WindingResistanceScale, motors: Motors) -> Motors:
    return motors.each(lambda motor: replace(motor, resistance_ohm=values.scale * motor.resistance_ohm))


TERM = Term(
    WindingResistanceScale,
    Slot.MOTORS,
    cause="another winding, brushes and contacts, a warm winding",
    excitation="stall and low speed: current against voltage",
    apply=scaled,
)
