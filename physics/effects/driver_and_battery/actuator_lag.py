"""A driver whose voltage follows the command with a lag."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import LagTime
from physics.drivetrain.first_order import lag_of_constant_input
from symolo.core.arrays import Array


class ActuatorLag(Effect):
    """The voltage at the motor follows the commanded voltage as through a first-order low-pass filter."""

    slot = Slot.ACTUATOR
    cause = "filtered or ramped PWM"
    excitation = "steps of voltage, after which the current rises late"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    time_constant_s: LagTime
    """Time constant of the first-order lag of the voltage behind the command."""

    def apply(self, held_V: Array, command_V: Array, duration_s: float) -> Array:
        return lag_of_constant_input(held_V, command_V, duration_s, self.time_constant_s)
