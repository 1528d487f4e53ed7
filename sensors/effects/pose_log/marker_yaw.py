"""A tracked body that is mounted askew on the robot."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter, Plausible
from symolo.core.arrays import Array

HEADING = np.array([0.0, 0.0, 1.0])


class MarkerYaw(Effect):
    """The logged heading differs from that of the robot by a constant angle."""

    slot = Slot.POSE_POINT
    cause = "a tracked body whose axis was set askew at the start of the session"
    excitation = "straight drives, in which the tracked body moves sideways"
    setups = (Setup.DRIVE,)

    angle_rad: Annotated[
        float,
        Parameter("rad", null=0.0, start=0.02, low=-3.2, high=3.2),
        Plausible(-0.35, 0.35, "an axis that is set by eye is within 20 degrees of that of the robot"),
    ]
    """tracked heading = heading of the body + angle, the same for a whole session."""

    def apply(self, pose: Array) -> Array:
        """Return the pose (..., 3) with the tracked heading, x [m], y [m], yaw [rad]."""
        return pose + self.angle_rad * HEADING
