"""Trajectories of the TUM RGB-D benchmark and of evo: a line `timestamp tx ty tz qx qy qz qw` for each pose.

The format: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats.
"""

from pathlib import Path

import numpy as np

from logs.axis import Axis
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from logs.trajectories.pose_lines import check_times, numbers_in_first_line, read_pose_lines
from symolo.core.errors import InputError
from symolo.core.geometry.poses import rotations

NAMES = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")
_MIN_LENGTH = 0.5
"""Smallest length of a quaternion; rounding changes that of a unit quaternion by much less."""


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    table, lines = read_pose_lines(path, NAMES)
    check_times(table[:, 0], lines, path)
    short = np.flatnonzero(np.abs(np.linalg.norm(table[:, 4:], axis=1) - 1.0) > _MIN_LENGTH)
    if len(short):
        where = f"{path}: row {lines[int(short[0])]}"
        raise InputError("qx qy qz qw", where=where, got=table[short[0], 4:].tolist(), allowed="a unit quaternion")
    floor = on_floor(
        table[:, 1:4],
        rotations(table[:, 4:]),
        str(path),
        up=settings.up,
        forward=settings.forward,
        up_if_level=Axis.MINUS_Y,  # as of a camera whose world is the frame of its first image
    )
    quantities = {"t": "timestamp, in s", **floor.quantities}
    return [
        LoggedTrajectory(
            table[:, 0].copy(),
            floor.pose,
            quantities,
            changes=floor.changes,
            guesses=floor.guesses,
            warnings=floor.warnings,
        )
    ]


READER = TrajectoryReader(
    "tum",
    "poses of the TUM benchmark or evo: t x y z qx qy qz qw",
    lambda path: numbers_in_first_line(path) == 8,
    _read,
)
