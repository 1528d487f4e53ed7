"""The exposure of the rows of an image, and the poses of camera and obstacles during it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sensors.camera.lens_warp import pinhole_image
from sensors.camera.views import FrameView, Moment
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array, triple
from symolo.core.geometry.pinhole import Intrinsics, Shutter
from symolo.core.geometry.poses import PlanarPose, as_rows, pose_X_WR
from symolo.core.geometry.robot_path import RobotPath

MOMENTS = 5
"""Number of moments of an exposure. On an arc of 0.2 rad, linear motion between them errs by 0.1 % of the length."""


@dataclass(frozen=True)
class Window:
    """The time in which the pinhole image of a view is exposed, which has more rows than the final image."""

    opens_s: float
    """Start relative to the time of the view; usually negative."""
    length_s: float
    row_share: float
    """Exposure of one row as a share of the window."""


def window(shutter: Shutter, camera: Intrinsics) -> Window:
    """Return the window of a shutter; its length is 0 for an instant.

    Cycles exposes the middle of row r of H rows a share (r + 1) / H - 0.5 of its read-out after the middle of the
    window (kernel/camera/camera.h). This is half a row later than in `Shutter.row_opens_s`.
    """
    pinhole = pinhole_image(camera)
    row_s = shutter.read_out_s / camera.height_px
    rows = pinhole.camera.height_px
    length_s = shutter.exposure_s + row_s * rows
    middle_s = row_s * (0.5 * (rows - camera.height_px) - pinhole.top_px - 0.5)
    return Window(middle_s - 0.5 * length_s, length_s, shutter.exposure_s / length_s if length_s else 1.0)


def moment(arena: Arena, X_RC: Array, pose: PlanarPose, t_s: float) -> Moment:
    """Return the poses of camera and obstacles at a time when the robot is at a pose."""
    moving = tuple(triple(box.poses_at(np.array([max(t_s, 0.0)]))[0]) for box in arena.moving)
    return Moment(pose, as_rows(pose_X_WR(*pose) @ X_RC), moving)


def exposed(
    views: Sequence[FrameView], arena: Arena, X_RC: Array, path: RobotPath, exposure: Window
) -> tuple[FrameView, ...]:
    """Return the views with the moments of their exposures."""
    result = []
    for view in views:
        times = view.t_s + exposure.opens_s + exposure.length_s * np.linspace(0.0, 1.0, MOMENTS)
        poses = zip(path.poses_at(times), times.tolist(), strict=True)
        moments = tuple(moment(arena, X_RC, triple(pose), t_s) for pose, t_s in poses)
        result.append(replace(view, exposure=moments))
    return tuple(result)
