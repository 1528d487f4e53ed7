"""The lowest row of an image in which meshes are visible, by their edges."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import Mesh
from sensors.camera.views import FrameView, Moment
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics
from symolo.core.geometry.poses import pose_X_WR

_BEYOND_PX = 2.0
"""Distance beyond the image's borders within which things are visible through the pixel filter."""
_NEAREST_M = 1e-3
"""Minimum depth of a visible point."""


class EdgesInSight:
    """Edges of all meshes of a scene, of which a view shows some."""

    def __init__(
        self, camera: Intrinsics, standing: Sequence[Mesh], moving: Sequence[Mesh], on_robot: Sequence[Mesh] = ()
    ) -> None:
        """Take the edges of meshes in W, of moving meshes, and of the robot; the camera has no distortion."""
        self._camera = camera
        self._standing = _edges(standing)
        self._moving = [_edges(on_robot), *(_edges([mesh]) for mesh in moving)]
        # Inside are the points p_C with p_C @ plane >= 0: right of the left border, left of the right one.
        left, right = -0.5 - _BEYOND_PX - camera.cx_px, camera.width_px - 0.5 + _BEYOND_PX - camera.cx_px
        self._sides = np.array([(camera.fx_px, 0.0, -left), (-camera.fx_px, 0.0, right)])

    def lowest_row(self, view: FrameView) -> int:
        """Return the last row with a piece of an edge, at most the image's height; -1 without any.

        Hidden edges count as well, at all moments of the exposure. A face that fills the image without a visible edge
        is not detected.
        """
        moments = view.exposure or (Moment(view.robot_pose, view.X_WC, view.moving),)
        return max(self._lowest(moment) for moment in moments)

    def _lowest(self, moment: Moment) -> int:
        X_WC, poses = np.array(moment.X_WC), [pose_X_WR(*pose) for pose in (moment.robot_pose, *moment.moving)]
        moved = [ends @ X[:3, :3].T + X[:3, 3] for ends, X in zip(self._moving, poses, strict=True)]
        ends = (np.concatenate([self._standing, *moved]) - X_WC[:3, 3]) @ X_WC[:3, :3]
        begin, along = ends[:, 0], ends[:, 1] - ends[:, 0]
        # Clip each edge, as a range of its length from 0 to 1, by the near plane and both sides of the image
        # (Liang and Barsky 1984); an edge that is outside of one plane has an empty range.
        first, last = np.zeros(len(ends)), np.ones(len(ends))
        for inside in (ends[..., 2] - _NEAREST_M, *(ends @ plane for plane in self._sides)):
            crossed = inside[:, 0] / np.where(inside[:, 0] == inside[:, 1], np.inf, inside[:, 0] - inside[:, 1])
            first = np.where(inside[:, 0] < 0, np.maximum(first, crossed), first)
            last = np.where(inside[:, 1] < 0, np.minimum(last, crossed), last)
            last[(inside < 0).all(axis=1)] = -1.0
        seen = first <= last
        pieces = begin[seen, None] + np.stack([first, last], axis=1)[seen, :, None] * along[seen, None]
        rows = self._camera.fy_px * pieces[..., 1] / pieces[..., 2] + self._camera.cy_px
        in_sight = (rows.max(axis=1) > -_BEYOND_PX) & (rows.min(axis=1) < self._camera.height_px + _BEYOND_PX)
        lowest = np.ceil(rows[in_sight].max(initial=-1.0))
        return int(min(lowest, self._camera.height_px))


def _edges(meshes: Sequence[Mesh]) -> NDArray[np.float64]:
    """Return both ends (N, 2, 3) of each edge of the faces, once per mesh."""
    ends: list[Array] = [np.zeros((0, 2, 3))]
    for mesh in meshes:
        pairs = {tuple(sorted(pair)) for face in mesh.faces for pair in zip(face, (*face[1:], face[0]), strict=True)}
        ends.append(np.array(mesh.vertices, float)[np.array(sorted(pairs), int)])
    return np.concatenate(ends)
