"""Coulomb friction other than nominal."""

from dataclasses import replace

from configs.schema.effects.motor import CoulombFrictionScale
from physics.drivetrain.motor import Motors
from physics.effects.base import Slot, Term


def scaled(values: CoulombFrictionScale, motors: Motors) -> Motors:
    return motors.each(lambda motor: replace(motor, coulomb_N_m=values.scale * motor.coulomb_N_m))


TERM = Term(
    CoulombFrictionScale,
    Slot.MOTORS,
    cause="a dry or a new gearbox, side load on the shaft",
    excitation="no-load current at low speed, and breakaway",
    apply=scaled,
)
