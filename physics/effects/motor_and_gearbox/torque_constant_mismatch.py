"""Different torque constants of the two motors of one robot."""

from dataclasses import replace

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Asymmetry
from physics.drivetrain.motor import Motors


class TorqueConstantMismatch(Effect):
    """The torque constants K of both motors differ in opposite directions from their mean, which is nominal."""

    slot = Slot.MOTORS
    cause = "magnets or gearboxes from different batches"
    excitation = "the same voltage on both wheels"
    setups = (Setup.DRIVE,)

    mismatch: Asymmetry
    """K_left = K (1 + mismatch/2), K_right = K (1 - mismatch/2)."""

    def apply(self, motors: Motors) -> Motors:
        left, right = 1.0 + 0.5 * self.mismatch, 1.0 - 0.5 * self.mismatch
        return Motors(
            right=replace(motors.right, torque_constant_N_m_A=right * motors.right.torque_constant_N_m_A),
            left=replace(motors.left, torque_constant_N_m_A=left * motors.left.torque_constant_N_m_A),
        )
