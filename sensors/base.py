"""What every sensor has in common: when it samples, what it may look at, and what it hands over.

Rate, delay, noise, quantisation and dropout are separate settings. A sensor updates every `period_steps` and a value
is delivered `delay_steps` later; between two deliveries the reader sees the one before. Only updates that somebody
reads are computed.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array


class Hits(Protocol):
    """Result of a ray cast; the first thing each ray meets, the robot itself left out."""

    @property
    def fraction(self) -> Array:
        """(N,), of the way from origin to end; 1 where nothing was met."""
        ...

    @property
    def surface(self) -> NDArray[np.int64]:
        """(N,), -1 nothing, 0 the floor, 1 + i for box i of the arena."""
        ...

    @property
    def normal(self) -> Array:
        """(N, 3), unit normal of what was met, in W; zero where nothing was."""
        ...


class World(Protocol):
    """What a sensor may look at."""

    @property
    def time_s(self) -> float:
        """Since the start of the run, which is also when everything was switched on."""
        ...

    def pose(self) -> tuple[float, float, float]:
        """X_WR: x [m], y [m], yaw [rad, unwrapped] of the middle of the axle."""
        ...

    def cast(self, origins: Array, ends: Array) -> Hits:
        """Cast rays from `origins` to `ends`, (N, 3) each, in W."""
        ...

    def encoder_counts(self) -> tuple[int, int]:
        """Right and left."""
        ...


@dataclass(frozen=True)
class Sampling:
    """When a sensor samples, in physics steps."""

    period_steps: int
    delay_steps: int

    @classmethod
    def from_seconds(cls, period_s: float, delay_s: float, physics_hz: int) -> "Sampling":
        return cls(max(1, round(period_s * physics_hz)), round(delay_s * physics_hz))

    def step_read_at(self, step: int) -> int:
        """Physics step of the newest sample that has been delivered at `step`; the first sample until then."""
        return max(0, (step - self.delay_steps) // self.period_steps * self.period_steps)


class Sensor(ABC):
    """One device with its own random stream."""

    sampling: Sampling

    @abstractmethod
    def sample(self, world: World) -> NDArray[np.float64] | NDArray[np.int64]:
        """One reading of the world as it stands now."""


def quantise(value: Array, step: float) -> Array:
    """Round to whole steps; a step of 0 leaves the value as it is."""
    return np.rint(value / step) * step if step > 0 else value
