"""Trajectories of the TUM RGB-D benchmark and of evo."""

from collections.abc import Sequence
from pathlib import Path

from logs.axis import Axis
from logs.recognition import names_above_numbers
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from logs.trajectories.quantities import QUATERNION, TRAJECTORY
from symolo.core.tables.pose_lines import numbers_in_first_line
from symolo.core.tables.tum_file import read_tum

_COLUMNS = ("t_s", "x_m", "y_m", "z_m", *QUATERNION)


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    poses = read_tum(path)
    floor = on_floor(
        poses.place_m,
        poses.rotation,
        str(path),
        up=settings.up,
        forward=settings.forward,
        up_if_level=Axis.MINUS_Y,  # as of a camera whose world is the frame of its first image
    )
    quantities = {"t": "timestamp, in s", **floor.quantities}
    return [
        LoggedTrajectory(
            poses.t_s,
            floor.pose,
            quantities,
            changes=floor.changes,
            guesses=floor.guesses,
            warnings=floor.warnings,
        )
    ]


def _recognises(path: Path) -> bool:
    """Return whether the first row has eight numbers, unless names above them show other columns."""
    return numbers_in_first_line(path) == len(_COLUMNS) and not _has_other_columns(names_above_numbers(path))


def _has_other_columns(header: Sequence[str]) -> bool:
    """Return whether a header is that of another table: with a heading, without z, or in another order."""
    names = TRAJECTORY.matched(header)
    if not TRAJECTORY.suffices(names):
        return False
    return (
        "theta_rad" in names
        or "z_m" not in names
        or any(names.get(name, column) != column for name, column in zip(_COLUMNS, header, strict=False))
    )


READER = TrajectoryReader(
    "tum",
    "poses of the TUM benchmark or evo: t x y z qx qy qz qw",
    _recognises,
    _read,
)
