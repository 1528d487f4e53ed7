"""Poses of the robot from those of a body that is not above the middle of its axle, such as a camera or a marker."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from logs.trajectories.base import LoggedTrajectory
from logs.trajectories.planar import PLACE_OF_CAMERA


def moved_to_axle(
    trajectories: Sequence[LoggedTrajectory], body_at_m: tuple[float, float] | None
) -> Iterator[LoggedTrajectory]:
    """Yield trajectories whose places are those of the middle of the axle.

    Args:
        trajectories: Trajectories of a body with the heading of the robot.
        body_at_m: Place of the body on the robot; None if it is not known, which leaves the trajectories as they are.
    """
    if body_at_m is None:
        yield from trajectories
        return
    x_m, y_m = body_at_m
    note = f"places of a body at x = {x_m:g} m, y = {y_m:g} m on the robot are moved to the middle of its axle"
    for trajectory in trajectories:
        c, s = np.cos(trajectory.pose[:, 2]), np.sin(trajectory.pose[:, 2])
        pose = trajectory.pose - np.column_stack((c * x_m - s * y_m, s * x_m + c * y_m, np.zeros(len(c))))
        warnings = tuple(warning for warning in trajectory.warnings if warning != PLACE_OF_CAMERA)
        yield replace(trajectory, pose=pose, changes=(*trajectory.changes, note), warnings=warnings)
