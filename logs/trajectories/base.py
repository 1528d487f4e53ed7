"""A trajectory that a log holds, and the interface of what reads it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from logs.axis import Axis
from logs.mapping import LogMapping
from symolo.core.arrays import Array
from symolo.core.progress import Report
from symolo.dataset.tables.column import Column


@dataclass(frozen=True)
class ReadSettings:
    """Settings with which logs are read; the defaults recognise axes, columns and units."""

    mapping: Path | None = None
    """Mapping file of a table; by default columns and units are recognised."""
    up: Axis | None = None
    """Axis of the log's world frame that points up; by default recognised from the poses."""
    forward: Axis | None = None
    """Axis of the tracked body along which the robot drives; by default recognised from the path."""
    heading_from_path: bool = False
    """Whether the direction of the path is the heading, for a log without headings."""
    pose_hz: float | None = None
    """Rate of the poses of a file without times."""
    body_at_m: tuple[float, float] | None = None
    """Place of the tracked body on the robot, x ahead and y to the left of the middle of the axle [m]; None if it is
    not known, and the places of the log are taken for those of the middle of the axle."""
    topics: tuple[str, ...] = ()
    """Topics of a bag, or frames such as `map:base_link`, that give the pose; by default the best there are."""
    report: Report | None = field(default=None, compare=False)
    """Receiver of the progress of reading a large log; None for none."""


@dataclass(frozen=True)
class LoggedTable:
    """Measurements of a log that have no columns in data.csv, at the times of the poses."""

    name: str
    meaning: str
    columns: Mapping[str, tuple[str, Array]]
    """Unit and values (N,) by column; NaN where nothing was measured."""


@dataclass(frozen=True)
class LoggedSensor:
    """Samples of a sensor at times of their own."""

    name: str
    kind: str
    """Kind of a sensor of a robot, such as `lidar`."""
    meaning: str
    t_s: Array
    """(N,), increasing, in the clock of the log."""
    columns: tuple[Column, ...]
    values: Array
    """(N, cells of all columns), NaN where nothing was measured."""
    settings: Mapping[str, float]
    """Known settings of the sensor, by their names in `robot.sensors`."""


@dataclass(frozen=True)
class LoggedCamera:
    """Images of a camera, with its lens."""

    name: str
    t_s: Array
    """(N,), increasing, in the clock of the log."""
    files: tuple[bytes, ...]
    """(N,), JPEG files in colour."""
    size: tuple[int, int]
    """Width and height [px] of each image."""
    K: Array
    """(3, 3), camera matrix [px]; pixel (0, 0) is the middle of the first pixel."""
    distortion_model: Literal["plumb_bob", "equidistant"]
    D: tuple[float, ...]
    """Five coefficients of `plumb_bob`, or four of `equidistant`."""
    settings: Mapping[str, float]
    """Period and place on the robot, by their names in `robot.sensors`."""


@dataclass(frozen=True)
class LoggedTrajectory:
    """A trajectory in SI units and the axes of this project: W has z up, and R has x forward."""

    t_s: Array
    """(N,), increasing, in the clock of the log."""
    pose: Array
    """(N, 3), x [m], y [m], yaw [rad, wrapped or not] of the robot in W."""
    quantities: Mapping[str, str]
    """Source of each quantity, such as a column with its unit."""
    readings: Mapping[str, Array] = field(default_factory=dict)
    """(N,) by column of data.csv; NaN where nothing was measured, and infinity where a range sensor saw no target."""
    tables: tuple[LoggedTable, ...] = ()
    changes: tuple[str, ...] = ()
    """Changes of the data, except those of units, in one sentence each, such as a tilt that was left out."""
    guesses: tuple[str, ...] = ()
    """Guesses that the user has to check, in one sentence each."""
    warnings: tuple[str, ...] = ()
    """Suspicious properties of the trajectory, in one sentence each."""
    name: str = ""
    """Name within a log of several trajectories, such as a topic."""
    sensors: tuple[LoggedSensor, ...] = ()
    cameras: tuple[LoggedCamera, ...] = ()
    mapping: LogMapping | None = None
    """Mapping with which a table was read, guesses included; None for other forms."""

    def __post_init__(self) -> None:
        for array in (self.t_s, self.pose, *self.readings.values()):
            array.flags.writeable = False


@dataclass(frozen=True)
class TrajectoryReader:
    """Reads the trajectories in one kind of file or folder."""

    name: str
    """Value of `--format`."""
    what: str
    """Description in a few words."""
    recognises: Callable[[Path], bool]
    """Function that returns whether a file or folder has this form, from names and first bytes; it never raises."""
    read: Callable[[Path, ReadSettings], Sequence[LoggedTrajectory]]
    """Function that reads the trajectories strictly, or raises InputError with file, row and column."""


def axis_vector(axis: Axis) -> Array:
    """Return the unit vector (3,) of an axis."""
    vector = np.zeros(3)
    vector[axis.number] = axis.sign
    return vector
