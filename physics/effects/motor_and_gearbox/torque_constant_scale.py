"""A torque constant, and with it a back-EMF, that is not nominal."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Plausible, Scale
from physics.drivetrain.motor import Motors


class TorqueConstantScale(Effect):
    """The torque constant K of both motors, which is also their back-EMF constant, differs from the nominal one."""

    slot = Slot.MOTORS
    cause = "a different or an aged magnet, a different gear ratio"
    excitation = "high speed (speed against voltage)"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    scale: Annotated[
        Scale,
        Plausible(
            0.7, 1.2, "ferrite loses 0.2 % per kelvin reversibly; only demagnetisation causes a larger, permanent loss"
        ),
    ]
    """K_true = scale * K, in torque and back-EMF."""

    def apply(self, motors: Motors) -> Motors:
        return motors.each(lambda motor: replace(motor, torque_constant_N_m_A=self.scale * motor.torque_constant_N_m_A))
