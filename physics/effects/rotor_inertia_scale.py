"""Rotor inertia other than nominal."""

from dataclasses import replace

from configs.schema.effects.motor import RotorInertiaScale
from physics.drivetrain.motor import Motors
from physics.effects.base import Slot, Term


def scaled(values: RotorInertiaScale, motors: Motors) -> Motors:
    return motors.each(lambda motor: replace(motor, inertia_kg_m2=values.scale * motor.inertia_kg_m2))


TERM = Term(
    RotorInertiaScale,
    Slot.MOTORS,
    cause="another rotor or wheel, another mass of the robot",
    excitation="steps of voltage: time constant of the speed",
    apply=scaled,
)
