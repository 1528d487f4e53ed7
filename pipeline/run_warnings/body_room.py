"""Bodies that are too close to the line, or to the path past an obstacle, for the size of the robot."""

import math
from collections.abc import Iterator

import numpy as np

from configs.arena_generation.clearance import distance_to
from configs.schema.controller import Avoidance
from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from physics.control.paths import straight_path
from pipeline.run_warnings.suspicion import Suspicion
from symolo.arena.footprints import Rectangle, obstacle_footprint, overlap, wall_footprint
from symolo.arena.geometry import Line
from symolo.core.arrays import Array

RESERVE = 0.1
"""Room beside the body that the control needs, as a share of the width of the body."""
SPACING_M = 0.02
BEND_RAD = 0.1
"""Turn of the line before an obstacle from which on the path past it does not begin straight ahead of it."""


def too_close(spec: RunSpec, line: Line) -> Iterator[Suspicion]:
    """Yield each wall and obstacle that the body of the robot touches, or nearly touches, where the line leads past it.

    Obstacles that move, and those from a mesh, which may have room below them, are left out.
    """
    poses = _line_poses(line)
    if np.cos(poses[_nearest(poses, spec), 2] - math.radians(spec.start.yaw_deg)) < 0:
        poses = poses[::-1] + np.array([0.0, 0.0, math.pi])
    bodies = [(f"wall {wall.name}", wall_footprint(wall)) for wall in spec.arena.walls]
    still = (box for box in spec.arena.obstacles if box.motion is None and box.mesh is None and box.solid)
    bodies += [(f"obstacle {box.name}", obstacle_footprint(box)) for box in still]
    for name, body in bodies:
        inside = _contains(body, poses)
        if not inside.any():
            yield from _beside(spec.robot, name, body, poses)
        elif name.startswith("obstacle") and spec.robot.controller.avoidance.curves is None:
            yield from _passed(spec.robot, name, body, poses, int(np.argmax(inside)))


def _beside(robot: RobotConfig, name: str, other: Rectangle, poses: Array) -> Iterator[Suspicion]:
    """Yield a wall or obstacle that the body touches or nearly touches, as with a corner that swings out in a bend."""
    body_m, reserve_m = (robot.chassis.length_m, robot.chassis.width_m), RESERVE * robot.chassis.width_m
    room_m, at = _room_m(body_m, poses, other, reserve_m)
    if room_m >= reserve_m:
        return
    comes = f"leaves {math.floor(1000.0 * room_m)} mm between itself and" if room_m >= 0.0 else "touches"
    needs = f", and the control needs about {1000.0 * reserve_m:.0f} mm" if room_m >= 0.0 else ""
    yield Suspicion(
        f"beside {name}",
        f"the body of the robot, {body_m[0]:g} m x {body_m[1]:g} m, {comes} {name} if it follows the line, at"
        f" x = {poses[at, 0]:.2f}, y = {poses[at, 1]:.2f} m{needs}: move one of them (a random arena keeps"
        " arena.generate.clearance.beside_m free on both sides of the line)",
    )


def _passed(robot: RobotConfig, name: str, box: Rectangle, poses: Array, first: int) -> Iterator[Suspicion]:
    """Yield an obstacle on the line that the path on its left does not lead the body past.

    The robot passes an obstacle on its left if that side is free.
    """
    avoidance, body_m = robot.controller.avoidance, (robot.chassis.length_m, robot.chassis.width_m)
    before_m = avoidance.front_below_m + robot.tof.mounts.front.x_m
    x, y, yaw = poses[first].tolist()
    straight = poses[max(0, first - math.ceil(before_m / SPACING_M)) : first + 1, 2]
    if np.abs(np.sin(0.5 * (straight - yaw))).max() > 0.5 * BEND_RAD:
        return
    start = (x - before_m * math.cos(yaw), y - before_m * math.sin(yaw), yaw)
    reserve_m = RESERVE * robot.chassis.width_m
    room_m, _ = _room_m(body_m, _path_poses(avoidance, start), box, reserve_m)
    if room_m >= reserve_m:
        return
    body = f"the body of the robot ({body_m[0]:g} m x {body_m[1]:g} m)"
    enough = (
        f"leaves {math.floor(1000.0 * room_m)} mm between it and {body}, which needs about {1000.0 * reserve_m:.0f} mm"
    )
    yield Suspicion(
        f"path past {name}",
        f"the path past {name}, {avoidance.side_m:g} m beside the line,"
        f" {enough if room_m >= 0 else f'leaves no room for {body}'}: enlarge the lengths of"
        " robot.controller.avoidance, as `scale` in the file of the robot does, or choose a smaller obstacle (in a"
        " random arena: arena.generate.max_obstacle_m)",
    )


def _path_poses(avoidance: Avoidance, start: tuple[float, float, float]) -> Array:
    """Return poses (N, 3) on the path on the left of an obstacle, which begins at a pose."""
    points = straight_path(avoidance, "left").points
    spaced = points[:: max(1, round(len(points) * SPACING_M / avoidance.along_length_m / 4))]
    steps = np.gradient(spaced, axis=0)
    c, s = math.cos(start[2]), math.sin(start[2])
    place = start[:2] + spaced @ np.array([[c, s], [-s, c]])
    return np.column_stack([place, start[2] + np.arctan2(steps[:, 1], steps[:, 0])])


def _room_m(body_m: tuple[float, float], poses: Array, other: Rectangle, enough_m: float) -> tuple[float, int]:
    """Return the smallest room [m] between a rectangle and a body at the poses (N, 3), and the number of its pose.

    The room is -1 where they overlap, and infinite if it is nowhere below `enough_m`.
    """
    corners, smallest = np.array(other.corners()), (math.inf, 0)
    near = distance_to(other, poses[:, :2]) < 0.5 * math.hypot(*body_m) + enough_m
    for index in np.flatnonzero(near).tolist():
        x, y, yaw = poses[index].tolist()
        body = Rectangle((x, y), body_m, yaw)
        if overlap(body, other):
            return -1.0, index
        # Two convex outlines that do not overlap are nearest at a corner of one of them.
        room_m = min(distance_to(other, np.array(body.corners())).min(), distance_to(body, corners).min())
        smallest = min(smallest, (float(room_m), index))
    return smallest if smallest[0] < enough_m else (math.inf, 0)


def _line_poses(line: Line) -> Array:
    """Return poses (N, 3) along the line, in the order of its pieces."""
    parts = []
    for piece in line.pieces:
        along_m = np.linspace(0.0, piece.length_m, 2 + int(piece.length_m / SPACING_M))
        points = piece.at(along_m)
        left = piece.at(along_m, 1.0) - points
        parts.append(np.column_stack([points, np.arctan2(-left[:, 0], left[:, 1])]))
    return np.concatenate(parts)


def _nearest(poses: Array, spec: RunSpec) -> int:
    return int(np.argmin(np.hypot(poses[:, 0] - spec.start.x_m, poses[:, 1] - spec.start.y_m)))


def _contains(rectangle: Rectangle, poses: Array) -> np.ndarray:
    c, s = math.cos(rectangle.yaw_rad), math.sin(rectangle.yaw_rad)
    local = (poses[:, :2] - rectangle.center) @ np.array([[c, -s], [s, c]])
    return np.all(np.abs(local) <= 0.5 * np.array(rectangle.size), axis=1)
