"""The common part of all sensors: when a sensor samples, what it may read, and what it delivers.

Rate, delay, noise, quantisation and dropout are separate settings. A sensor takes a sample every `period_steps`. The
controller receives the sample `delay_steps` later and uses it until the next one arrives. Samples that nobody reads are
not computed.
"""

import inspect
import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from configs.robot_sensors import SensorSettings
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from physics.robot.body_motion import BodyMotion
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.geometry.poses import PlanarPose
from symolo.dataset.tables.column import Column, Series
from symolo.dataset.tables.sensor_tables import sensor_table
from symolo.dataset.tables.side_tables import SideTable

Reading = NDArray[np.float64] | NDArray[np.int64]


class Hits(Protocol):
    """Result of a ray cast: the first surface that each ray meets; rays pass through the robot."""

    @property
    def fraction(self) -> Array:
        """(N,), fraction of the distance from origin to end; 1 without a hit."""
        ...

    @property
    def surface(self) -> NDArray[np.int64]:
        """(N,), -1 for no hit, 0 for the floor, 1 + i for box i of the arena."""
        ...

    @property
    def normal(self) -> Array:
        """(N, 3), unit normal of the surface in W; zero without a hit."""
        ...


class World(Protocol):
    """The part of the world that a sensor may read."""

    @property
    def time_s(self) -> float:
        """Time since the start of the run, at which everything was switched on."""
        ...

    def pose(self) -> PlanarPose:
        """Return X_WR: x [m], y [m], yaw [rad, unwrapped] of the middle of the axle."""
        ...

    def motion(self) -> BodyMotion:
        """Return the motion of the body in space."""
        ...

    def cast(self, origins: Array, ends: Array, time_s: float | None = None) -> Hits:
        """Cast rays from `origins` to `ends`, (N, 3) each, in W; obstacles are where they are at `time_s`, or now."""
        ...

    def wheel_angles(self) -> tuple[float, float]:
        """Return the angles [rad] by which the wheels have turned, right and left, as encoders count them."""
        ...

    def encoder_counts(self) -> tuple[int, int]:
        """Return the counts of both encoders, right and left, since the start."""
        ...


@dataclass(frozen=True)
class Sampling:
    """When a sensor samples, in physics steps."""

    period_steps: int
    delay_steps: int
    subsamples_before: tuple[int, ...] = ()
    """Numbers of steps before each sample at which the sensor reads the world too (`subsample`), the largest first."""

    @classmethod
    def from_seconds(cls, period_s: float, delay_s: float, physics_hz: int) -> "Sampling":
        """Return a period and a delay rounded to whole physics steps; a period has at least one."""
        return cls(max(1, round(period_s * physics_hz)), round(delay_s * physics_hz))

    def step_read_at(self, step: int) -> int:
        """Return the physics step of the newest sample that has been delivered by `step`.

        Before the first delivery, it is the step of the first sample.
        """
        return max(0, (step - self.delay_steps) // self.period_steps * self.period_steps)


class Sensor(ABC):
    """One device with its own random stream.

    A new class derives `Settings` from `SensorSettings`, lists its `columns` and defines `sample`. It is then a kind of
    `robot.sensors`: each sensor of this kind has settings `robot.sensors.<name>`, and its samples are the table
    `side/<name>.csv` of a dataset. The first paragraph of the docstring is the meaning of the table.
    """

    name: ClassVar[str]
    """Name of the kind: that of the class in lower case with underscores (`RearBumper` is `rear_bumper`), unless a
    class sets a different one. For a sensor that every robot has, it is also the last part of the path of the random
    stream; for a sensor of `robot.sensors`, that is the name of the sensor."""
    Settings: ClassVar[type[Section]] = Section
    """Settings in the description of the robot."""
    columns: ClassVar[tuple[Column, ...]] = ()
    """Columns of a dataset that hold a reading; for a sensor whose columns depend on its settings, see `columns_of`."""
    series: ClassVar[tuple[Series, ...]] = ()
    """Series of a recording that hold the delivered readings of a sensor that every robot has."""
    is_rendered: ClassVar[bool] = False
    """Whether its samples are images, which are rendered after the simulation."""
    sampling: Sampling

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        if "name" not in vars(cls):
            cls.name = re.sub(r"(?<=.)(?=[A-Z])", "_", cls.__name__).lower()
        if "series" in vars(cls):
            cls.columns = tuple(column for series in cls.series for column in series.columns)

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        """Build the sensor of one run.

        Args:
            settings: The settings with their values in this run.
            arena: The arena in which the robot drives.
            physics_hz: Number of physics steps per second.
            rng: Random stream of this sensor alone.
        """
        self.settings, self.arena, self.rng = settings, arena, rng
        self.sampling = Sampling.from_seconds(settings.period_s, settings.delay_s, physics_hz)

    @classmethod
    def is_listed(cls) -> bool:
        """Return whether it is a sensor of `robot.sensors`; every robot has the others."""
        return issubclass(cls.Settings, SensorSettings)

    @classmethod
    def on_robot(cls, robot: RobotConfig, arena: Arena, physics_hz: int, rng: np.random.Generator) -> "Sensor | None":
        """Return a sensor that every robot has, or None if this robot does not need it."""
        raise NotImplementedError

    @classmethod
    def columns_of(cls, settings: SensorSettings) -> tuple[Column, ...]:
        """Return the columns of a sensor with these settings."""
        del settings
        return cls.columns

    @classmethod
    def table(cls, name: str, settings: SensorSettings) -> SideTable:
        """Return the table of the dataset with the samples of a sensor of `robot.sensors`."""
        meaning = " ".join(inspect.cleandoc(cls.__doc__ or cls.name).partition("\n\n")[0].split())
        return sensor_table(name, meaning, cls.columns_of(settings))

    def subsample(self, world: World) -> None:
        """Read the world at one of the steps of `sampling.subsamples_before`, for the sample that follows."""
        raise NotImplementedError

    @abstractmethod
    def sample(self, world: World) -> Reading:
        """Return one reading of the world in its current state."""

    def recorded(self, reading: Reading) -> tuple[Reading, ...]:
        """Return the part of a reading that goes into each of `series`."""
        return (reading,)

    def checked(self, reading: Reading, t_s: float) -> Array:
        """Return a reading of a sensor of `robot.sensors` at a time, as its table contains it.

        Raises:
            InputError: The reading is not one finite number for each column.
        """
        columns = self.columns_of(self.settings)
        if np.shape(reading) != (sum(column.count for column in columns),) or not np.isfinite(reading).all():
            names = ", ".join(column.title for column in columns)
            allowed = f"a finite number for each column: {names}"
            code = getattr(type(self).sample, "__code__", None)
            where = f"{code.co_filename}:{code.co_firstlineno}" if code else ""
            what = f"sensor {self.name}: the reading at {t_s:.3f} s"
            raise InputError(what, where=where, got=str(reading), allowed=allowed)
        return np.array(reading, dtype=np.float64)  # a copy, since a sensor may return the same array again


def quantise(value: Array, step: float) -> Array:
    """Return the value rounded to whole steps; a step of 0 does not change it."""
    return np.rint(value / step) * step if step > 0 else value
