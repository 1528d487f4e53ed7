"""Trajectories of KITTI's odometry benchmark: three rows of four numbers in each line, and times in another file.

A pose is that of the camera in its frame at the first image, x right, y down, z forward
(Geiger, Lenz, Urtasun, CVPR 2012; the benchmark's development kit). Sequences that SyMoLo exported also have the pose
of that frame in origin.txt, and that of the robot in the camera as Tr in calib.txt, so the poses of the robot follow.
"""

from pathlib import Path

import numpy as np

from logs.axis import Axis
from logs.recognition import is_file
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.text_file import read_text
from symolo.core.progress import plural
from symolo.core.tables.pose_lines import check_times, numbers_in_first_line, read_pose_lines
from symolo.core.tables.table import number

NAMES = tuple(f"{name}" for row in "123" for name in (f"r{row}1", f"r{row}2", f"r{row}3", f"t{row}"))
TIMES, ORIGIN, CALIBRATION = "times.txt", "origin.txt", "calib.txt"


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    table, lines = read_pose_lines(path, NAMES)
    X_OB = table.reshape(-1, 3, 4)
    t_s, source = _times(path, len(X_OB), settings.pose_hz)
    check_times(t_s, lines, path)
    up, forward, changes = settings.up or Axis.MINUS_Y, settings.forward, ()
    origin = _beside(path, ORIGIN)
    if origin is not None:
        _check_axes(settings, origin)
        X_OB, up, forward = _robot_poses(X_OB, origin), Axis.Z, Axis.X
        changes = (f"poses of the camera are turned into those of the robot with {ORIGIN} and {CALIBRATION}",)
    floor = on_floor(X_OB[:, :, 3], X_OB[:, :, :3], str(path), up=up, forward=forward)
    quantities = {"t": source, **floor.quantities}
    changes += floor.changes
    return [
        LoggedTrajectory(t_s, floor.pose, quantities, changes=changes, guesses=floor.guesses, warnings=floor.warnings)
    ]


def _beside(path: Path, name: str) -> Path | None:
    """Return the file of this name beside the poses or in their sequence, if there is one."""
    places = (path.with_name(name), path.absolute().parents[1] / "sequences" / path.stem / name)
    return next((place for place in places if is_file(place)), None)


def _check_axes(settings: ReadSettings, origin: Path) -> None:
    """Refuse axes and a place of the body for poses that are those of the robot."""
    body_at = settings.body_at_m and ",".join(f"{place_m:g}" for place_m in settings.body_at_m)
    options = {"--up": settings.up, "--forward": settings.forward, "--body-at": body_at}
    for option, value in options.items():
        if value is not None:
            cure = f"leave it out: with {origin}, the poses are those of the robot, whose axes are known"
            raise InputError(option, got=value, cure=cure)


def _robot_poses(X_C0C: Array, origin: Path) -> Array:
    """Return X_WR (N, 3, 4) for poses of the camera, with X_WC0 in origin.txt and Tr = X_CR in calib.txt beside it."""
    table, _ = read_pose_lines(origin, NAMES)
    X_WC0, X_CR = _whole(table[0].reshape(3, 4)), _whole(_robot_in_camera(origin.with_name(CALIBRATION)))
    return (X_WC0 @ _whole(X_C0C) @ X_CR)[:, :3]


def _whole(X: Array) -> Array:
    """Return transforms (..., 4, 4) with their last row."""
    last = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (*X.shape[:-2], 1, 4))
    return np.concatenate((X, last), axis=-2)


def _robot_in_camera(calibration: Path) -> Array:
    """Return X_CR (3, 4), the entry Tr of calib.txt."""
    lines = read_text(calibration).lines if is_file(calibration) else ()
    cells = next((line.split()[1:] for line in lines if line.startswith("Tr:")), [])
    if len(cells) != len(NAMES):
        what = f"has no line Tr with twelve numbers, the pose of the robot in the camera, which {ORIGIN} needs"
        cure = f"export the sequence again, or remove {ORIGIN} to read the poses as those of a camera"
        raise InputError(what, where=str(calibration), cure=cure)
    return np.array([number(cell, "Tr", str(calibration)) for cell in cells]).reshape(3, 4)


def _times(path: Path, count: int, pose_hz: float | None) -> tuple[Array, str]:
    """Return the times [s] of the poses and their source: a rate, or times.txt beside the file or in its sequence."""
    if pose_hz is not None:
        return np.arange(count) / pose_hz, f"row number, at {pose_hz:g} Hz"
    file = _beside(path, TIMES)
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
