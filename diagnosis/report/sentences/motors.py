"""The torque constants of both motors of the fitted robot, which show whether one motor alone differs."""

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.report.sentences.sizes import sizes_text
from physics.robot.model import RobotModel
from symolo.core.arrays import Array


def torque_constants(named: NamedEffect, diagnosis: Diagnosis, sign: str = "±") -> str:
    """Return the torque constants of both motors, each with the nominal one; empty if they are equal.

    Args:
        named: An effect that is named; only those of the motors change these numbers.
        diagnosis: The diagnosis.
        sign: Sign between a number and its standard error.
    """
    left, right = _constants_N_m_A(diagnosis.fit.robot).tolist()
    if named.effect.kind.slot is not Slot.MOTORS or left == right:
        return ""
    return sizes_text(("left", "right"), _constants_N_m_A, "N m/A", diagnosis, sign)


def _constants_N_m_A(robot: RobotConfig) -> Array:
    """Return the torque constants of the left and the right motor."""
    motors = RobotModel.from_config(robot).motors
    return np.array([motors.left.torque_constant_N_m_A, motors.right.torque_constant_N_m_A])
