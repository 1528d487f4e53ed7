"""A tracked point that is not over the axle."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class MarkerOffset(Effect):
    """The logged position is that of a point ahead of the axle or behind it."""

    slot = Slot.POSE_POINT
    cause = "a marker that is not mounted over the axle"
    excitation = "turns on the spot"
    setups = (Setup.DRIVE,)

    offset_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-0.5, high=0.5)]
    """Distance of the tracked point ahead of the axle."""

    def apply(self, pose: Array) -> Array:
        """Return the pose (..., 3) of the tracked point, x [m], y [m], yaw [rad]."""
        yaw = pose[..., 2]
        step = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=-1)
        return pose + self.offset_m * step
