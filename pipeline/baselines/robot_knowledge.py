"""The knowledge of a robot in a run, and no more: its readings, its drawing, the map, and where it starts.

Only `RobotKnowledge.from_tables` sees more: the true poses, and the hidden effects and sensor errors of the robot. It
passes none of these on to a method.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import radians

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import LineSensor, RobotConfig, TofMount
from configs.schema.scenario import RunSpec
from pipeline.baselines.further_sensors.readings import FurtherReadings
from sensors.line.line_sensor import channel_weights
from sensors.wheels.odometry import Odometry
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.codes import TofStatus
from symolo.dataset.tables.rows import Ints, Rows
from symolo.dataset.tables.side_tables import TOF, WHEELS

Pixels = NDArray[np.uint8]

THUMBNAIL = (24, 32)
"""Height and width [px] of the small image that the method `retrieval` reads."""
NO_FURTHER = FurtherReadings()
SLIP_M_SQRT_M = 3e-4
"""Standard deviation [m] of the random error of a wheel's travel after 1 m, if none is given. The variance
grows with the distance (Chong and Kleeman, "Accurate odometry and error modelling for a mobile robot", ICRA 1997). This
is usual for rubber on a clean floor."""
MAP_SD_M = 0.003
"""Standard deviation of the position of tape, walls and obstacles against the map."""


@dataclass(frozen=True)
class LineRow:
    """Positions and field of view of the channels of the line sensor."""

    x_m: float
    y_m: Array
    """(8,), from the robot's right to its left."""
    spot_sd_m: float
    """Standard deviation [m] of the field of view of a channel along each axis."""

    @classmethod
    def from_sensor(cls, sensor: LineSensor) -> "LineRow":
        diameter_m = sensor.spot_diameter_at_floor_m + sensor.spot_growth * sensor.height_m
        # A uniform disc of diameter D has a standard deviation of D / 4 along each axis.
        return cls(sensor.x_m, channel_weights(sensor.channels) * sensor.pitch_m, 0.25 * diameter_m)


@dataclass(frozen=True)
class RobotDrawing:
    """Numbers of a robot from its drawing and the data sheets of its parts."""

    odometry: Odometry
    mounts: tuple[TofMount, TofMount, TofMount]
    """Mounts of the ToF sensors: front, left, right."""
    field_of_view_rad: float
    longest_range_m: float
    range_period_s: float
    line: LineRow

    @classmethod
    def from_robot(cls, robot: RobotConfig) -> "RobotDrawing":
        tof = robot.tof
        return cls(
            odometry=Odometry.from_config(robot),
            mounts=(tof.mounts.front, tof.mounts.left, tof.mounts.right),
            field_of_view_rad=radians(tof.field_of_view_deg),
            longest_range_m=tof.max_range_m,
            range_period_s=tof.period_s,
            line=LineRow.from_sensor(robot.line_sensor),
        )


@dataclass(frozen=True)
class Start:
    """The start pose as the robot estimates it, with its uncertainty."""

    pose: Array
    """(3,), x [m], y [m], yaw [rad] in W."""
    sd: Array
    """(3,), standard deviation of the error of each: x [m], y [m], yaw [rad]."""


@dataclass(frozen=True)
class RunImages:
    """The images of a run without their poses."""

    rows: Ints
    """(M,), row of data.csv of each image."""
    pixels: Callable[[int], Pixels]
    """Returns the i-th image, (H, W, 3), uint8 RGB."""

    @cached_property
    def thumbnails(self) -> Array:
        """Small grey images (M, 24, 32), from 0 to 1."""
        return self.grey(THUMBNAIL)

    def grey(self, size: tuple[int, int]) -> Array:
        """Return grey images (M, height, width), from 0 to 1, of this height and width [px].

        Each pixel is the mean over its area.
        """
        import cv2  # noqa: PLC0415 - takes half a second, and only methods that learn read images

        wide = size[::-1]
        small = [cv2.resize(self.pixels(i), wide, interpolation=cv2.INTER_AREA).mean(axis=2) for i in range(len(self))]
        return np.array(small) / 255.0

    def __len__(self) -> int:
        return len(self.rows)


@dataclass(frozen=True)
class RobotKnowledge:
    """The log of one run as its robot has it, with N rows."""

    t_s: Array
    """(N,), time of each row [s]."""
    counts: Ints
    """(N, 2), counts of the right and left encoder since the start."""
    ranges_m: Array
    """(N, 3), ranges [m] front, left, right; nan where there was no target."""
    fresh: NDArray[np.bool_]
    """(N, 3), whether a range is a new reading; False where the reading before is held."""
    on_line: NDArray[np.bool_]
    """(N, 8), whether a channel of the line sensor is over the tape, right to left."""
    start: Start
    drawing: RobotDrawing
    map: Arena
    """Shapes of line, walls and standing obstacles, all of equal material and brightness, without what moves."""
    images: RunImages | None
    further: FurtherReadings = NO_FURTHER
    """Readings of the sensors of `robot.sensors`."""
    slip_m_sqrt_m: float = SLIP_M_SQRT_M
    """Standard deviation [m] of the random error of the distance that a wheel rolls, after 1 m."""

    @classmethod
    def from_tables(
        cls,
        spec: RunSpec,
        rows: Rows,
        *,
        wheels: Array,
        tof: Array,
        start: Start,
        images: RunImages | None,
        further: FurtherReadings = NO_FURTHER,
        slip_m_sqrt_m: float = SLIP_M_SQRT_M,
    ) -> "RobotKnowledge":
        """Return the knowledge in data.csv, side/wheels.csv and side/tof.csv without their columns of true values."""
        arena = Arena.from_config(spec.arena)
        standing = tuple(replace(box, surface="white_board") for box in arena.boxes if box.motion is None)
        line = replace(arena.line, reflectance=0.0)
        status = tof[:, TOF.header.index("status_f") :][:, :3]
        counts = wheels[:, WHEELS.header.index("counts_r") :][:, :2]
        return cls(
            t_s=rows.t_ms / 1000,
            counts=np.rint(counts).astype(np.int64),
            ranges_m=np.where(status == TofStatus.NO_TARGET, np.nan, rows.tof_m),
            fresh=status != TofStatus.HELD,
            on_line=rows.line < spec.robot.line_sensor.threshold,
            start=start,
            drawing=RobotDrawing.from_robot(spec.robot),
            map=replace(arena, boxes=standing, floor_reflectance=1.0, line=line),
            images=images,
            further=further,
            slip_m_sqrt_m=slip_m_sqrt_m,
        )

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.t_s)
