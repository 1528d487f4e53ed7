"""Place of a moving obstacle at any time, in closed form, for rays, contacts, images and tables."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from symolo.arena.footprints import stations as stations_of
from symolo.arena.forms import ObstacleForm
from symolo.core.arrays import Array

Pose = tuple[float, float, float]


@dataclass(frozen=True)
class ObstacleMotion:
    """Constant speed from one station to the next."""

    times_s: tuple[float, ...]
    """(K,), from 0, strictly increasing [s]."""
    poses: tuple[Pose, ...]
    """(K, 3), x [m], y [m], yaw [rad, unwrapped] in W at these times."""
    repeats: bool
    """Whether the obstacle starts again after its last station, which then equals the first; otherwise it stays."""

    @classmethod
    def from_config(cls, obstacle: ObstacleForm) -> "ObstacleMotion | None":
        """Return the motion of an obstacle; None if it stands still."""
        if obstacle.motion is None:
            return None
        times, places = zip(*stations_of(obstacle), strict=True)
        poses = tuple((*place.center, place.yaw_rad) for place in places)
        if obstacle.motion.repeat == "back_and_forth":
            back = tuple(2.0 * times[-1] - time_s for time_s in reversed(times[:-1]))
            times, poses = (*times, *back), (*poses, *reversed(poses[:-1]))
        return cls(times, poses, repeats=obstacle.motion.repeat != "once")

    @cached_property
    def _slopes(self) -> Array:
        """(K, 3), rates after each station [m/s, m/s, rad/s]; zero after the last."""
        stations = zip(self.times_s, self.poses, strict=True)
        legs = [np.subtract(b, a) / (t1 - t0) for (t0, a), (t1, b) in pairwise(stations)]
        return np.array([*legs, np.zeros(3)])

    def poses_at(self, t_s: Array) -> Array:
        """Return the poses (N, 3), x [m], y [m], yaw [rad], at times (N,) [s] since the start of the run."""
        phase_s = self._phase_s(t_s)
        return np.stack([np.interp(phase_s, self.times_s, column) for column in zip(*self.poses, strict=True)], axis=-1)

    def rates_at(self, t_s: Array) -> Array:
        """Return (N, 3), the velocity [m/s, m/s] and yaw rate [rad/s] in W from each of the times (N,) on."""
        leg = np.searchsorted(self.times_s, self._phase_s(t_s), side="right") - 1
        return self._slopes[leg]

    def _phase_s(self, t_s: Array) -> Array:
        return t_s % self.times_s[-1] if self.repeats else t_s
