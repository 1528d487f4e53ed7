"""Two motors of one robot that are not alike."""

from dataclasses import replace

from configs.schema.effects.drive import TorqueConstantMismatch
from physics.drivetrain.motor import Motors
from physics.effects.base import Slot, Term


def mismatched(values: TorqueConstantMismatch, motors: Motors) -> Motors:
    left, right = 1.0 + 0.5 * values.mismatch, 1.0 - 0.5 * values.mismatch
    return Motors(
        right=replace(motors.right, torque_constant_N_m_A=right * motors.right.torque_constant_N_m_A),
        left=replace(motors.left, torque_constant_N_m_A=left * motors.left.torque_constant_N_m_A),
    )


TERM = Term(
    TorqueConstantMismatch,
    Slot.MOTORS,
    cause="magnets or gearboxes of two batches",
    excitation="the same voltage on both wheels",
    apply=mismatched,
)
