"""Boxes in space: size and pose of walls and obstacles."""

import numpy as np

from blender_scenes.annotations.job import Solid
from blender_scenes.annotations.seen import VisibleScene
from symolo.core.arrays import Array
from symolo.core.poses import Matrix4
from symolo.dataset.annotations import Box3D

_DECIMALS = 9


def box_3d(seen: VisibleScene, solid: Solid) -> Box3D:
    X_WO = solid.pose_X_WO(seen.pose_X_WI(solid.instance_id))
    return Box3D(solid.size_m, rows_of(X_WO), rows_of(np.linalg.inv(seen.X_WC) @ X_WO))


def rows_of(matrix: Array) -> Matrix4:
    """Return the rows of a matrix, rounded to nine digits, which is a nanometre."""
    rounded = np.round(matrix, _DECIMALS) + 0.0  # no -0.0
    a, b, c, d = ((float(r[0]), float(r[1]), float(r[2]), float(r[3])) for r in rounded)
    return a, b, c, d
