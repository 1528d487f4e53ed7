"""Coulomb friction that is not nominal."""

from dataclasses import replace

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Scale
from physics.drivetrain.motor import Motors


class CoulombFrictionScale(Effect):
    """The Coulomb friction Tc of both motors, which does not depend on the speed, differs from the nominal one."""

    slot = Slot.MOTORS
    cause = "a dry or a new gearbox, side load on the shaft"
    excitation = "no-load current at low speed, and breakaway"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    scale: Scale
    """Tc_true = scale * Tc."""

    def apply(self, motors: Motors) -> Motors:
        return motors.each(lambda motor: replace(motor, coulomb_N_m=self.scale * motor.coulomb_N_m))
