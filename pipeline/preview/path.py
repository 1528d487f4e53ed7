"""The path of a robot around an arena without a simulation: on the line and beside the walls."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from configs.schema.arena import WallConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from symolo.arena.footprints import Rectangle, overlap
from symolo.arena.geometry import Arc, Arena, Box, Line, Straight
from symolo.core.geometry.poses import PlanarPose

_JOINED_M = 0.01
"""Largest distance [m] between the ends of two pieces of the line that are joined."""
_STEP_M = 0.02
_DIFFERENCE_M = 1e-5


@dataclass(frozen=True)
class Leg:
    """A piece of the path, driven from its start to its end or backwards."""

    piece: Straight | Arc
    backwards: bool = False

    def pose_at(self, s_m: float) -> PlanarPose:
        """Return the pose of R after that length of the piece, facing along it."""
        s = self.piece.length_m - s_m if self.backwards else s_m
        here, behind, ahead = self.piece.at(np.array([s, s - _DIFFERENCE_M, s + _DIFFERENCE_M]))
        along = behind - ahead if self.backwards else ahead - behind
        return float(here[0]), float(here[1]), math.atan2(along[1], along[0])


@dataclass(frozen=True)
class PreviewPath:
    """The path of a run: its legs, all in the direction in which its start turns about their centre."""

    legs: tuple[Leg, ...]
    start: PlanarPose
    boxes: tuple[Box, ...]
    robot: RobotConfig

    @classmethod
    def from_spec(cls, spec: RunSpec, arena: Arena) -> "PreviewPath":
        start = (spec.start.x_m, spec.start.y_m, math.radians(spec.start.yaw_deg))
        pieces: list[Straight | Arc] = list(arena.line.pieces)
        if not _is_closed(arena.line):
            pieces += [_beside(wall, spec.robot) for wall in spec.arena.walls]
        return cls(_in_sense_of(start, pieces), start, arena.boxes, spec.robot)

    def place(self, share: float, t_s: float) -> PlanarPose:
        """Return the pose after `share` (0-1) of the path, or the last one before it where the robot has room at that
        time.

        Without line and walls, or without room anywhere, it is the start of the run.
        """
        length_m = sum(leg.piece.length_m for leg in self.legs)
        for back in range(math.ceil(length_m / _STEP_M)):
            pose = self._pose_at((share * length_m - back * _STEP_M) % length_m)
            if self._has_room(pose, t_s):
                return pose
        return self.start

    def _pose_at(self, s_m: float) -> PlanarPose:
        for leg in self.legs:
            if s_m <= leg.piece.length_m:
                return leg.pose_at(s_m)
            s_m -= leg.piece.length_m
        return self.legs[-1].pose_at(self.legs[-1].piece.length_m)  # rounding left a rest

    def _has_room(self, pose: PlanarPose, t_s: float) -> bool:
        """Return whether there is nothing at the robot, nor closer ahead of it than where its controller turns
        aside.
        """
        chassis, mounts = self.robot.chassis, self.robot.tof.mounts
        back_m = -0.5 * chassis.length_m
        front_m = mounts.front.x_m + self.robot.controller.avoidance.front_below_m
        middle_m, yaw = 0.5 * (back_m + front_m), pose[2]
        center = pose[0] + middle_m * math.cos(yaw), pose[1] + middle_m * math.sin(yaw)
        taken = Rectangle(center, (front_m - back_m, chassis.width_m), yaw)
        places = (box.poses_at(np.array([t_s]))[0].tolist() for box in self.boxes)
        return not any(
            overlap(taken, Rectangle((x, y), box.size[:2], turned))
            for box, (x, y, turned) in zip(self.boxes, places, strict=True)
        )


def _is_closed(line: Line) -> bool:
    """Return whether every piece is joined to another one at both ends; walls join the ends of an open line."""
    ends = [piece.at(np.array([0.0, piece.length_m])) for piece in line.pieces]
    for number, piece_ends in enumerate(ends):
        others = [end for other, pair in enumerate(ends) if other != number for end in pair]
        if any(all(math.dist(end, other) > _JOINED_M for other in others) for end in piece_ends):
            return False
    return True


def _beside(wall: WallConfig, robot: RobotConfig) -> Straight:
    """Return the track along a wall at which the side sensor has the distance that the controller holds."""
    (x0, y0), (x1, y1) = wall.start, wall.end
    length = math.hypot(x1 - x0, y1 - y0)
    away_m = robot.controller.wall.target_distance_m + abs(robot.tof.mounts.left.y_m)
    dx, dy = -(y1 - y0) / length * away_m, (x1 - x0) / length * away_m
    return Straight((x0 + dx, y0 + dy), (x1 + dx, y1 + dy))


def _in_sense_of(start: PlanarPose, pieces: Sequence[Straight | Arc]) -> tuple[Leg, ...]:
    """Return the legs in the direction of the start around the centre of all pieces, clockwise or counter-clockwise."""
    legs = [Leg(piece) for piece in pieces]
    halfway = [leg.pose_at(0.5 * leg.piece.length_m) for leg in legs]
    middle = np.mean([pose[:2] for pose in halfway], axis=0) if halfway else np.zeros(2)

    def turns_left(pose: PlanarPose) -> bool:
        return (pose[0] - middle[0]) * math.sin(pose[2]) > (pose[1] - middle[1]) * math.cos(pose[2])

    return tuple(Leg(leg.piece, turns_left(pose) != turns_left(start)) for leg, pose in zip(legs, halfway, strict=True))
