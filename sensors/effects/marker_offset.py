"""A tracked point that is not over the axle."""

import numpy as np

from configs.schema.effects.drive import MarkerOffset
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def ahead(values: MarkerOffset, pose: Array) -> Array:
    """Pose (..., 3) of the tracked point, x [m], y [m], yaw [rad]."""
    yaw = pose[..., 2]
    step = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=-1)
    return pose + values.offset_m * step


TERM = Term(
    MarkerOffset,
    Slot.POSE_POINT,
    cause="the marker is fixed where there is room",
    excitation="turns on the spot",
    apply=ahead,
)
