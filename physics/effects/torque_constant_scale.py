"""Torque constant, and with it back-EMF, other than nominal."""

from dataclasses import replace

from configs.schema.effects.motor import TorqueConstantScale
from physics.drivetrain.motor import Motors
from physics.effects.base import Slot, Term


def scaled(values: TorqueConstantScale, motors: Motors) -> Motors:
    return motors.each(lambda motor: replace(motor, torque_constant_N_m_A=values.scale * motor.torque_constant_N_m_A))


TERM = Term(
    TorqueConstantScale,
    Slot.MOTORS,
    cause="another or an aged magnet, another gear ratio",
    excitation="high speed: speed against voltage",
    apply=scaled,
)
