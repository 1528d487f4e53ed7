"""Trajectories of KITTI's odometry benchmark: three rows of four numbers in each line, and times in another file.

A pose is that of the camera in its frame at the first image, x right, y down, z forward
(Geiger, Lenz, Urtasun, CVPR 2012; the benchmark's development kit).
"""

from pathlib import Path

import numpy as np

from logs.axis import Axis
from logs.recognition import is_file
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from logs.trajectories.pose_lines import check_times, numbers_in_first_line, read_pose_lines
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural

NAMES = tuple(f"{name}" for row in "123" for name in (f"r{row}1", f"r{row}2", f"r{row}3", f"t{row}"))
TIMES = "times.txt"


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    table, lines = read_pose_lines(path, NAMES)
    X_OB = table.reshape(-1, 3, 4)
    t_s, source = _times(path, len(X_OB), settings.pose_hz)
    check_times(t_s, lines, path)
    up = settings.up or Axis.MINUS_Y
    floor = on_floor(X_OB[:, :, 3], X_OB[:, :, :3], str(path), up=up, forward=settings.forward)
    quantities = {"t": source, **floor.quantities}
    return [
        LoggedTrajectory(
            t_s, floor.pose, quantities, changes=floor.changes, guesses=floor.guesses, warnings=floor.warnings
        )
    ]


def _times(path: Path, count: int, pose_hz: float | None) -> tuple[Array, str]:
    """Return the times [s] of the poses and their source: a rate, or times.txt beside the file or in its sequence."""
    if pose_hz is not None:
        return np.arange(count) / pose_hz, f"row number, at {pose_hz:g} Hz"
    places = (path.with_name(TIMES), path.parents[1] / "sequences" / path.stem / TIMES)
    file = next((place for place in places if is_file(place)), None)
    if file is None:
        cure = "give the rate of the poses, such as --pose-hz 10"
        raise InputError(f"has no times, and there is no {TIMES} beside it", where=str(path), cure=cure)
    times, _ = read_pose_lines(file, ("t",))
    if len(times) != count:
        raise InputError(
            f"{plural(len(times), 'time')} for {plural(count, 'pose')}",
            where=str(file),
            cure=f"give those of {path.name}",
        )
    return times[:, 0], f"{TIMES}, in s"


READER = TrajectoryReader(
    "kitti",
    "poses of KITTI's odometry benchmark: 12 numbers in a line",
    lambda path: numbers_in_first_line(path) == len(NAMES),
    _read,
)
