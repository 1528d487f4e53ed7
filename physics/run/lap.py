"""A lap is closed when the robot has been away and is back at its start, in its starting direction."""

import math
from dataclasses import dataclass

from symolo.core.geometry.poses import PlanarPose


@dataclass
class LapDetector:
    """Detects that the lap of a run is closed, from the true poses of its robot."""

    start: PlanarPose
    away_m: float = 1.0
    """Driven distance [m] after which the robot has been away, whatever the size of the arena."""
    half_width_m: float = 0.10
    """Half width [m] of the finishing line."""
    window_m: float = 0.35
    """Distance [m] beyond the finishing line where the lap may still be closed, for a robot that returns beside the
    track."""
    max_turn_rad: float = math.radians(45.0)
    closed: bool = False
    _driven_m: float = 0.0
    _last: PlanarPose | None = None

    def update(self, pose: PlanarPose, *, on_track: bool) -> None:
        """Take the pose of one tick; the lap closes only while the robot follows its track."""
        dx, dy = pose[0] - self.start[0], pose[1] - self.start[1]
        if self._last is not None:
            self._driven_m += math.dist(pose[:2], self._last[:2])
        self._last = pose
        c, s = math.cos(self.start[2]), math.sin(self.start[2])
        along_m, beside_m = c * dx + s * dy, c * dy - s * dx
        turn_rad = math.remainder(pose[2] - self.start[2], 2 * math.pi)
        at_the_line = 0 <= along_m < self.window_m and abs(beside_m) < self.half_width_m
        self.closed |= self._driven_m > self.away_m and on_track and at_the_line and abs(turn_rad) < self.max_turn_rad
