"""Rotor inertia that is not nominal."""

from dataclasses import replace

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Scale
from physics.drivetrain.motor import Motors


class RotorInertiaScale(Effect):
    """The moment of inertia J that each motor accelerates differs from the nominal one."""

    slot = Slot.MOTORS
    cause = "a different rotor or wheel, a different mass of the robot"
    excitation = "steps of voltage (time constant of the speed)"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    scale: Scale
    """J_true = scale * J."""

    def apply(self, motors: Motors) -> Motors:
        return motors.each(lambda motor: replace(motor, inertia_kg_m2=self.scale * motor.inertia_kg_m2))
