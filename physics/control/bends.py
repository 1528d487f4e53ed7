"""Choice of the curve path around an obstacle on a bend, from the ranges and the recent path by odometry."""

import math
from collections import deque
from dataclasses import dataclass, field
from typing import Literal

from configs.schema.controller import Avoidance, CurveAvoidance
from physics.control.base import Observation, Side, opposite
from physics.control.paths import AvoidancePath, curve_path
from symolo.core.geometry.poses import PlanarPose

Variant = Literal["inner", "outer"]


@dataclass(frozen=True)
class CurvePass:
    """How an obstacle is to be passed."""

    side: Side
    """Side of the obstacle on which the robot passes."""
    variant: Variant
    bend: Side
    """Side to which the line bends."""
    near_m: float
    """Reading of the sensor that detected the obstacle; 0 if it lies between two beams."""


@dataclass(frozen=True)
class CurvePaths:
    """The pre-computed curve paths, by variant and side of the bend."""

    paths: dict[tuple[Variant, Side], AvoidancePath]

    @classmethod
    def from_config(cls, config: CurveAvoidance, count: int) -> "CurvePaths":
        paths: dict[tuple[Variant, Side], AvoidancePath] = {}
        for bend in ("left", "right"):
            paths["inner", bend] = curve_path(config.inner, count, bend)
            paths["outer", bend] = curve_path(config.outer, count, bend)
        return cls(paths)


@dataclass
class BendMemory:
    """How much the recent path has turned, and to which side it last bent."""

    length_m: float
    straight_below_rad: float
    bend: Side | None = None
    """Side of the last bend; None before the first."""
    turned_rad: float = 0.0
    """Change of the heading over the last `length_m` of the path."""
    _travelled_m: float = 0.0
    _recent: deque[tuple[float, PlanarPose]] = field(default_factory=deque)

    @property
    def is_straight(self) -> bool:
        return abs(self.turned_rad) < self.straight_below_rad

    def update(self, odometry: PlanarPose) -> None:
        if self._recent:
            self._travelled_m += math.dist(odometry[:2], self._recent[-1][1][:2])
        self._recent.append((self._travelled_m, odometry))
        while self._travelled_m - self._recent[0][0] > self.length_m:
            self._recent.popleft()
        self.turned_rad = odometry[2] - self._recent[0][1][2]
        if not self.is_straight:
            self.bend = "left" if self.turned_rad > 0 else "right"


def curve_pass(seen: Observation, bends: BendMemory, config: Avoidance) -> CurvePass | None:
    """Return how to pass the obstacle that is now in the way, or None without one.

    An obstacle straight ahead or at the end of the present bend is passed on the inside, where a tight line leaves most
    room. An obstacle beside a robot that has gone straight stands on the next bend and is passed on the outside.
    """
    curves = config.curves
    if curves is None:
        return None
    if seen.front_m < (curves.ahead_below_m if bends.is_straight else config.front_below_m):
        freer: Side = "left" if seen.left_m >= seen.right_m else "right"
        side = bends.bend or freer
        return CurvePass(side, "inner", side, seen.front_m)
    for side in ("left", "right"):
        if bends.bend not in {None, side}:
            continue
        side_m = seen.side_m(side)
        if side_m < curves.side_below_m:
            passed = opposite(side) if bends.is_straight else side
            return CurvePass(passed, "outer" if bends.is_straight else "inner", side, side_m)
        if bends.is_straight and max(side_m, seen.front_m) < curves.both_below_m:
            # An obstacle between the beams is nearer than either of them reads.
            return CurvePass(opposite(side), "outer", side, 0.0)
    return None
