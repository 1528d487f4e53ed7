"""A world in which the robot stands still, for one sensor in it."""

from dataclasses import dataclass, field
from math import radians
from typing import Protocol

import numpy as np

from physics.robot.body_motion import BodyMotion
from sensors.base import Hits
from symolo.core.arrays import Array
from symolo.core.geometry.poses import pose_X_WR


class RayCaster(Protocol):
    """Bodies that rays can hit: an arena in closed form, the same in PyBullet, or a body of another shape."""

    def cast(self, origins: Array, ends: Array) -> Hits: ...


@dataclass
class RayRecorder:
    """Passes every cast on to another caster and stores the last one."""

    caster: RayCaster
    origins: Array = field(default_factory=lambda: np.zeros((0, 3)))
    ends: Array = field(default_factory=lambda: np.zeros((0, 3)))
    fraction: Array = field(default_factory=lambda: np.zeros(0))

    def cast(self, origins: Array, ends: Array) -> Hits:
        hits = self.caster.cast(origins, ends)
        self.origins, self.ends, self.fraction = origins, ends, hits.fraction
        return hits

    def points(self) -> Array:
        """Return where the rays of the last cast ended, (N, 3) in W."""
        return self.origins + self.fraction[:, None] * (self.ends - self.origins)


@dataclass(frozen=True)
class StillWorld:
    """A world at time 0 with the robot at rest."""

    caster: RayCaster | None = None
    """Ray caster of the world; None for a sensor that casts no rays."""
    y_m: float = 0.0
    yaw_deg: float = 0.0

    @property
    def time_s(self) -> float:
        return 0.0

    def pose(self) -> tuple[float, float, float]:
        return 0.0, self.y_m, radians(self.yaw_deg)

    def motion(self) -> BodyMotion:
        x, y, yaw = self.pose()
        return BodyMotion(pose_X_WR(0.0, 0.0, yaw)[:3, :3], np.array([x, y, 0.0]), np.zeros(3), np.zeros(3))

    def wheel_angles(self) -> tuple[float, float]:
        return 0.0, 0.0

    def encoder_counts(self) -> tuple[int, int]:
        return 0, 0

    def cast(self, origins: Array, ends: Array, time_s: float | None = None) -> Hits:
        del time_s
        if self.caster is None:
            raise NotImplementedError("nothing in this world can be hit by a ray")
        return self.caster.cast(origins, ends)
