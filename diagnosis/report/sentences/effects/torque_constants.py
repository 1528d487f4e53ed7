"""The torque constants of both motors of the fitted robot, which show whether one motor alone differs."""

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.report.sentences.effects.sizes import sizes_text
from physics.robot.model import RobotModel
from symolo.core.arrays import Array


def torque_constants(named: NamedEffect, diagnosis: Diagnosis, sign: str = "±") -> str:
    """Return the torque constants of both motors, each with the nominal one; empty if they are equal.

    Args:
        named: An effect that is named; the text is that of the first one that changes these numbers.
        diagnosis: The diagnosis.
        sign: Sign between a number and its standard error.
    """
    left, right = _constants_N_m_A(diagnosis.fit.robot).tolist()
    if left == right or named is not next((each for each in diagnosis.named if _changes_them(each, diagnosis)), None):
        return ""
    return sizes_text(("left", "right"), _constants_N_m_A, "N m/A", diagnosis, sign)


def _changes_them(named: NamedEffect, diagnosis: Diagnosis) -> bool:
    """Return whether the fitted robot has other torque constants with this effect than without it."""
    effect, robot = named.effect, diagnosis.fit.robot
    if effect.kind.slot is not Slot.MOTORS:
        return False
    without = robot.with_effect(effect.kind.null(dict(effect.choices)))
    return not np.array_equal(_constants_N_m_A(without), _constants_N_m_A(robot))


def _constants_N_m_A(robot: RobotConfig) -> Array:
    """Return the torque constants of the left and the right motor."""
    motors = RobotModel.from_config(robot).motors
    return np.array([motors.left.torque_constant_N_m_A, motors.right.torque_constant_N_m_A])
