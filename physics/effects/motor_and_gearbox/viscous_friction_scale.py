"""Viscous friction that is not nominal."""

from dataclasses import replace

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Scale
from physics.drivetrain.motor import Motors


class ViscousFrictionScale(Effect):
    """The viscous friction of both motors, B times the speed, differs from the nominal one."""

    slot = Slot.MOTORS
    cause = "stiff or thin grease, misaligned bearings"
    excitation = "current against speed over a wide range of speeds"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    scale: Scale
    """B_true = scale * B."""

    def apply(self, motors: Motors) -> Motors:
        return motors.each(lambda motor: replace(motor, viscous_N_m_s_rad=self.scale * motor.viscous_N_m_s_rad))
