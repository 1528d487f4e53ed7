"""A world in which the robot stands still, for one sensor to look at."""

from dataclasses import dataclass
from math import radians
from typing import Protocol

from sensors.base import Hits
from symolo.core.arrays import Array


class RayCaster(Protocol):
    """What rays are cast against: an arena in closed form, the same in PyBullet, or a body of another shape."""

    def cast(self, origins: Array, ends: Array) -> Hits: ...


@dataclass(frozen=True)
class StillWorld:
    """A world at time 0 with the robot at rest."""

    caster: RayCaster | None = None
    """None for a sensor that casts no rays."""
    x_m: float = 0.0
    y_m: float = 0.0
    yaw_deg: float = 0.0

    @property
    def time_s(self) -> float:
        return 0.0

    def pose(self) -> tuple[float, float, float]:
        return self.x_m, self.y_m, radians(self.yaw_deg)

    def encoder_counts(self) -> tuple[int, int]:
        return 0, 0

    def cast(self, origins: Array, ends: Array) -> Hits:
        if self.caster is None:
            raise NotImplementedError("nothing in this world can be hit by a ray")
        return self.caster.cast(origins, ends)
