"""One run as it is shown over time: path, arena, images, and plots of whatever was recorded."""

from dataclasses import dataclass

from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints
from symolo.pages.states import Dash
from symolo.reader.run_folder import Image


@dataclass(frozen=True)
class PlottedCurve:
    """One quantity in a plot."""

    name: str
    values: Array
    """(M,), in the unit of the plot; NaN where there is none, such as for a range sensor that saw no target."""
    colour: str
    dash: Dash


@dataclass(frozen=True)
class CurvePlot:
    """Curves of one unit over the same times."""

    title: str
    unit: str
    """Unit, for example `m/s`; empty for numbers without a unit."""
    t_s: Array
    """(M,), times of the values [s]."""
    curves: tuple[PlottedCurve, ...]
    from_zero: bool = False
    """Whether the axis begins at 0 even if all values are far from it."""


@dataclass(frozen=True)
class StripePlot:
    """Many channels of one unit over the same times, as a strip of greys."""

    title: str
    unit: str
    t_s: Array
    """(M,), times of the values [s]."""
    names: tuple[str, ...]
    """Name of each channel, the lowest stripe first."""
    levels: Array
    """(M, channels), 0 black to 1 white."""


@dataclass(frozen=True)
class CameraTrack:
    """The images of one camera."""

    name: str
    width_px: int
    height_px: int
    images: tuple[Image, ...]
    """Images in the order of time, at least one."""


@dataclass(frozen=True)
class Beam:
    """A range sensor on the robot, as its readings are drawn on a map."""

    name: str
    x_m: float
    y_m: float
    yaw_rad: float
    """Place and direction in the robot's frame R."""
    range_m: Array
    """(N,), NaN where it saw no target."""
    colour: str
    """Colour of its curve in the plot of the ranges."""


@dataclass(frozen=True)
class Scan:
    """A lidar on the robot, as its scans are drawn on a map."""

    name: str
    x_m: float
    y_m: float
    """Place in the robot's frame R."""
    angles_rad: Array
    """(K,), direction of each ray in R."""
    t_s: Array
    """(M,), time of each scan."""
    range_m: Array
    """(M, K), NaN for a ray without a return."""


@dataclass(frozen=True)
class RobotOutline:
    """What a map shows of the robot, around the middle of its axle."""

    length_m: float = 0.18
    width_m: float = 0.17
    track_m: float = 0.14
    wheel_diameter_m: float = 0.065


@dataclass(frozen=True)
class Playback:
    """What a page or a video shows of one run over time."""

    name: str
    """Name of the run, such as `CW/test_1`."""
    t_s: Array
    """(N,), time of each row."""
    pose: Array
    """(N, 3), x [m], y [m], theta [rad] in W."""
    state: Ints
    """(N,), state of the controller."""
    arena: Arena | None
    """Arena of the run; None if it is not known, such as for a run that symolo did not make."""
    robot: RobotOutline
    beams: tuple[Beam, ...]
    scans: tuple[Scan, ...]
    plots: tuple[CurvePlot | StripePlot, ...]
    cameras: tuple[CameraTrack, ...]
    """Cameras that took an image."""
