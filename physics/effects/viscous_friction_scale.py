"""Viscous friction other than nominal."""

from dataclasses import replace

from configs.schema.effects.motor import ViscousFrictionScale
from physics.drivetrain.motor import Motors
from physics.effects.base import Slot, Term


def scaled(values: ViscousFrictionScale, motors: Motors) -> Motors:
    return motors.each(lambda motor: replace(motor, viscous_N_m_s_rad=values.scale * motor.viscous_N_m_s_rad))


TERM = Term(
    ViscousFrictionScale,
    Slot.MOTORS,
    cause="stiff or thin grease, misaligned bearings",
    excitation="current against speed over a wide range of speeds",
    apply=scaled,
)
