"""The wheels of the fitted robot in numbers that can be measured: both diameters and the track, in millimetres."""

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.report.sentences.effects.sizes import sizes_text
from physics.robot.model import RobotModel
from symolo.core.arrays import Array


def wheel_sizes(named: NamedEffect, diagnosis: Diagnosis, sign: str = "±") -> str:
    """Return both diameters and the track of the fitted robot, each with the nominal one; empty for other effects.

    Args:
        named: An effect that is named; only those of the geometry change these sizes.
        diagnosis: The diagnosis.
        sign: Sign between a number and its standard error.
    """
    if named.effect.kind.slot is not Slot.GEOMETRY:
        return ""
    return sizes_text(("left diameter", "right diameter", "track"), _sizes_mm, "mm", diagnosis, sign)


def _sizes_mm(robot: RobotConfig) -> Array:
    """Return the diameters of the left and the right wheel, and the track."""
    geometry = RobotModel.from_config(robot).geometry
    return 1e3 * np.array([2.0 * geometry.left_radius_m, 2.0 * geometry.right_radius_m, geometry.track_m])
