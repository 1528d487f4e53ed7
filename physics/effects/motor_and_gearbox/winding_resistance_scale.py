"""Winding resistance that is not nominal."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Plausible, Scale
from physics.drivetrain.motor import Motors


class WindingResistanceScale(Effect):
    """The winding resistance R of both motors differs from the nominal one."""

    slot = Slot.MOTORS
    cause = "a different winding, brushes and contacts, a warm winding"
    excitation = "stall and low speed (current against voltage)"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    scale: Annotated[
        Scale, Plausible(0.8, 1.5, "copper gains 0.39 % per kelvin, so a factor of 1.5 would need a rise of 130 K")
    ]
    """R_true = scale * R."""

    def apply(self, motors: Motors) -> Motors:
        return motors.each(lambda motor: replace(motor, resistance_ohm=self.scale * motor.resistance_ohm))
