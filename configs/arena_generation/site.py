"""An incomplete arena with its line, walls and boxes so far, and the check that one more box leaves enough room."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from configs.arena_generation import clearance as room
from configs.arena_generation.outline import START_AHEAD_M, START_BEHIND_M
from configs.arena_generation.rejection import Rejected
from configs.arena_generation.track import Track
from configs.schema.arena import Obstacle, WallConfig
from configs.schema.arena_generator import Clearance
from symolo.arena.footprints import Rectangle, obstacle_footprint, overlap, wall_footprint
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose

SPACING_M = 0.02
"""Distance between two poses on the line at which the room is checked."""
NOTICED_M = (0.32, 0.28, 0.24)
"""Distances from an obstacle's face back to the axle at which the robot may decide on which side to pass."""
REGAINED_M = (0.23, 0.27, 0.31)
"""Distances behind an obstacle's middle at which the robot meets the line again and overshoots it."""
SWING_RAD = tuple(np.radians((45.0, 55.0, 65.0, 75.0)).tolist())
"""Headings relative to the line during the overshoot, away from the side on which the robot passed."""

STRAIGHT_RAD = 1e-9
"""Turn below which a piece of the line counts as straight."""

Side = Literal["left", "right"]


@dataclass(frozen=True)
class Passing:
    """How the robot passes one obstacle."""

    side: Side
    lane: Rectangle
    """Floor that the robot may use."""
    noticing: Array
    """(N, 3), poses of the robot while it decides."""
    regaining: Array
    """(N, 3), poses of the robot while it meets the line again."""


class Site:
    """Line and walls of an arena with the boxes that are placed so far."""

    def __init__(self, track: Track, walls: tuple[WallConfig, ...], half_extent_m: float, limits: Clearance) -> None:
        """Check whether line and walls alone leave enough room; the floor must contain them.

        Raises:
            Rejected: They leave too little room.
        """
        self.track, self.walls = track, walls
        self.obstacles: list[Obstacle] = []
        self.decoys: list[Obstacle] = []
        self._half_extent_m = half_extent_m
        self._limits = limits
        self._passings: list[Passing] = []
        count = round(track.length_m / SPACING_M)
        self._s = np.arange(count) * (track.length_m / count)
        self._poses = track.poses(self._s)
        if room.comes_near_itself(self._poses[:, :2], float(self._s[1]), limits.stretches_m):
            raise Rejected("the line comes too near itself")
        if any(self._in_the_way(wall_footprint(wall), self._poses) for wall in walls):
            raise Rejected("a wall is too near the line")

    def put_obstacle(self, box: Obstacle, at_m: float) -> bool:
        """Place a box on the line with its middle at a distance along it, if the robot has room to pass it."""
        limits, rectangle = self._limits, obstacle_footprint(box)
        begin_m, end_m = at_m - limits.before_m, at_m + limits.after_m
        if begin_m < self.track.start_m + START_AHEAD_M and end_m > self.track.start_m - START_BEHIND_M:
            return False
        # The yaw is constant on a straight; a bend between the three places would change it.
        if np.ptp(self.track.poses(np.array([begin_m, at_m, end_m]))[:, 2]) > STRAIGHT_RAD:
            return False
        frame: PlanarPose = tuple(self.track.poses(np.array([at_m]))[0].tolist())
        if np.abs(room.in_frame_of(frame, np.array(rectangle.corners()))[:, 1]).max() > limits.obstacle_reach_m:
            return False
        elsewhere = self._poses[(self._s < begin_m) | (self._s > end_m)]
        if self._meets_others(rectangle) or self._in_the_way(rectangle, elsewhere):
            return False
        passing = self._passing(box, at_m)
        if passing is None or (room.distance_to(passing.lane, elsewhere[:, :2]) == 0).any():
            return False
        if any(overlap(passing.lane, other) for other in self._rectangles()):
            return False
        if any(self._draws_off(passing, room.outline_of(obstacle_footprint(other))) for other in self._boxes()):
            return False
        self.obstacles.append(box)
        self._passings.append(passing)
        return True

    def put_decoy(self, box: Obstacle) -> bool:
        """Place a box next to the line, if it is not in the way."""
        rectangle = obstacle_footprint(box)
        if self._meets_others(rectangle) or self._in_the_way(rectangle, self._poses) or not self._within(rectangle):
            return False
        self.decoys.append(box)
        return True

    def _rectangles(self) -> list[Rectangle]:
        return [wall_footprint(wall) for wall in self.walls] + [obstacle_footprint(box) for box in self._boxes()]

    def _boxes(self) -> tuple[Obstacle, ...]:
        return (*self.obstacles, *self.decoys)

    def _in_the_way(self, rectangle: Rectangle, poses: Array) -> bool:
        """Return whether a robot at any of the poses (N, 3) would touch a box or detect it as an obstacle."""
        away = room.distance_to(rectangle, poses[:, :2])
        near = poses[away < self._limits.ahead_m + room.FRONT_SENSOR[0]]
        if away.min() < self._limits.beside_m:
            return True
        half_angle = room.HALF_FIELD_RAD + room.HEADING_RAD
        ahead = room.seen_m(near, room.FRONT_SENSOR, half_angle, room.outline_of(rectangle))
        return bool((ahead < self._limits.ahead_m).any())

    def _meets_others(self, rectangle: Rectangle) -> bool:
        """Return whether a box overlaps with a wall or another box, or disturbs the passing of an obstacle."""
        if any(overlap(rectangle, other) for other in self._rectangles()):
            return True
        points = room.outline_of(rectangle)
        return any(
            overlap(rectangle, passing.lane)
            or self._seen_on(passing.side, passing.noticing, points)
            or self._draws_off(passing, points)
            for passing in self._passings
        )

    def _seen_on(self, side: Side, poses: Array, points: Array) -> bool:
        """Return whether the sensor on a side would see any of the points (M, 2) too near to pass there."""
        sensor = room.LEFT_SENSOR if side == "left" else room.RIGHT_SENSOR
        half_angle = room.HALF_FIELD_RAD + 0.5 * room.HEADING_RAD
        return bool(room.seen_m(poses, sensor, half_angle, points).min() < self._limits.free_side_m)

    def _draws_off(self, passing: Passing, points: Array) -> bool:
        """Return whether the robot would see any of the points (M, 2) of a box while it overshoots the line.

        The robot may then lose the line for a moment and follow a box at its side like a wall. A real wall leads it
        along the line and back to it, but a box leads it away.
        """
        sensor = room.RIGHT_SENSOR if passing.side == "left" else room.LEFT_SENSOR
        seen = room.seen_m(passing.regaining, sensor, room.HALF_FIELD_RAD, points)
        return bool(seen.min() < self._limits.regained_side_m)

    def _passing(self, box: Obstacle, at_m: float) -> Passing | None:
        """Return a passing on the left if the left is free, on the right if the left is surely blocked, else None."""
        half_m = 0.5 * max(box.size[:2])
        noticing = self.track.poses(at_m - half_m - np.array(NOTICED_M))
        points = np.concatenate([room.outline_of(rectangle) for rectangle in self._rectangles()] or [np.empty((0, 2))])
        frame = self.track.poses(np.array([at_m]))[0]
        regained = self.track.poses(at_m + np.array(REGAINED_M))
        if not self._seen_on("left", noticing, points):
            return Passing("left", self._lane(frame, 1.0), noticing, _swung(regained, -1.0))
        blocked = [room.blocked_m(pose, room.LEFT_SENSOR, room.HALF_FIELD_RAD, points) for pose in noticing]
        if max(blocked) < self._limits.blocked_side_m and not self._seen_on("right", noticing, points):
            return Passing("right", self._lane(frame, -1.0), noticing, _swung(regained, 1.0))
        return None

    def _lane(self, frame: NDArray[np.float64], sign: float) -> Rectangle:
        """Return the floor that a passing uses, on the left of the line for sign 1 and on the right for -1."""
        limits = self._limits
        x, y, yaw = frame.tolist()
        along = 0.5 * (limits.after_m - limits.before_m)
        aside = sign * 0.5 * (limits.passing_m - limits.other_side_m)
        c, s = np.cos(yaw), np.sin(yaw)
        center = (float(x + c * along - s * aside), float(y + s * along + c * aside))
        return Rectangle(center, (limits.after_m + limits.before_m, limits.passing_m + limits.other_side_m), yaw)

    def _within(self, rectangle: Rectangle) -> bool:
        """Return whether a box is on the floor and within the walls, which means to the left of each of them."""
        if np.abs(rectangle.corners()).max() > self._half_extent_m:
            return False
        for wall in self.walls:
            (x0, y0), (x1, y1) = wall.start, wall.end
            if any((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) < 0 for x, y in rectangle.corners()):
                return False
        return True


def _swung(poses: Array, sign: float) -> Array:
    """Return the poses (N, 3) with every heading of the overshoot, (N * headings, 3); sign 1 turns them to the left."""
    turns = np.zeros((len(SWING_RAD), 1, 3))
    turns[:, 0, 2] = sign * np.array(SWING_RAD)
    return (poses + turns).reshape(-1, 3)
