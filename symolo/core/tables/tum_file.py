"""Files of the TUM RGB-D benchmark and of evo: a line `timestamp tx ty tz qx qy qz qw` for each pose.

The format: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.geometry.poses import rotations
from symolo.core.tables.pose_lines import check_times, read_pose_lines

NAMES = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")
_MIN_LENGTH = 0.5
"""Smallest length of a quaternion; rounding changes that of a unit quaternion by much less."""


@dataclass(frozen=True)
class TumPoses:
    """Poses in space."""

    t_s: Array
    """(N,), increasing."""
    place_m: Array
    """(N, 3)."""
    rotation: Array
    """(N, 3, 3)."""
    lines: tuple[int, ...]
    """Number of the line of each pose, from 1."""


def read_tum(path: Path) -> TumPoses:
    """Return the poses of a file.

    Raises:
        InputError: A line is no pose, or the times do not increase; the row is named.
    """
    table, lines = read_pose_lines(path, NAMES)
    check_times(table[:, 0], lines, path)
    short = np.flatnonzero(np.abs(np.linalg.norm(table[:, 4:], axis=1) - 1.0) > _MIN_LENGTH)
    if len(short):
        where = f"{path}: row {lines[int(short[0])]}"
        raise InputError("qx qy qz qw", where=where, got=table[short[0], 4:].tolist(), allowed="a unit quaternion")
    return TumPoses(table[:, 0].copy(), table[:, 1:4].copy(), rotations(table[:, 4:]), tuple(lines))
