"""Bodies that are too close to the line, or to the path past an obstacle, for the size of the robot."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

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
    body_m = (spec.robot.chassis.length_m, spec.robot.chassis.width_m)
    bodies = [(f"wall {wall.name}", wall_footprint(wall)) for wall in spec.arena.walls]
    still = (box for box in spec.arena.obstacles if box.motion is None and box.mesh is None and box.solid)
    bodies += [(f"obstacle {box.name}", obstacle_footprint(box)) for box in still]
    for name, body in bodies:
        inside = _contains(body, poses)
        if not inside.any():
            if _touch(body_m, poses, body):
                yield Suspicion(f"beside {name}", _beside(spec.robot, name))
        elif name.startswith("obstacle") and spec.robot.controller.avoidance.curves is None:
            yield from _passed(spec.robot, name, body, poses, int(np.argmax(inside)))


def _beside(robot: RobotConfig, name: str) -> str:
    chassis = robot.chassis
    return (
        f"the body of the robot, {chassis.length_m:g} m x {chassis.width_m:g} m, touches {name} if it follows the line:"
        " move one of them (a random arena keeps arena.generate.clearance.beside_m free on both sides of the line)"
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
    room_m = _room_m(avoidance, start, body_m, box, reserve_m)
    if room_m >= reserve_m:
        return
    body = f"the body of the robot ({body_m[0]:g} m x {body_m[1]:g} m)"
    enough = f"leaves {1000.0 * room_m:.0f} mm between it and {body}, which needs about {1000.0 * reserve_m:.0f} mm"
    yield Suspicion(
        f"path past {name}",
        f"the path past {name}, {avoidance.side_m:g} m beside the line,"
        f" {enough if room_m >= 0 else f'leaves no room for {body}'}: enlarge the lengths of"
        " robot.controller.avoidance, as `scale` in the file of the robot does, or choose a smaller obstacle (in a"
        " random arena: arena.generate.max_obstacle_m)",
    )


def _room_m(
    avoidance: Avoidance, start: tuple[float, float, float], body_m: tuple[float, float], box: Rectangle, max_m: float
) -> float:
    """Return the room [m], in steps of 1 mm up to about `max_m`, beside the body on the path; -1 if it touches."""
    points = straight_path(avoidance, "left").points
    spaced = points[:: max(1, round(len(points) * SPACING_M / avoidance.along_length_m / 4))]
    steps = np.gradient(spaced, axis=0)
    c, s = math.cos(start[2]), math.sin(start[2])
    place = start[:2] + spaced @ np.array([[c, s], [-s, c]])
    poses = np.column_stack([place, start[2] + np.arctan2(steps[:, 1], steps[:, 0])])
    if not _touch((body_m[0] + 2.0 * max_m, body_m[1] + 2.0 * max_m), poses, box):
        return max_m
    room_m = -1.0
    for grown_m in np.arange(0.0, max_m, 0.001):
        if _touch((body_m[0] + 2.0 * grown_m, body_m[1] + 2.0 * grown_m), poses, box):
            break
        room_m = float(grown_m)
    return room_m


def _touch(body_m: tuple[float, float], poses: Array, other: Rectangle) -> bool:
    """Return whether a body of this length and width at any of the poses (N, 3) overlaps with a rectangle."""
    reach_m = 0.5 * (math.hypot(*body_m) + math.hypot(*other.size))
    near: Sequence[Sequence[float]] = poses[np.hypot(*(poses[:, :2] - other.center).T) < reach_m].tolist()
    return any(overlap(Rectangle((x, y), body_m, yaw), other) for x, y, yaw in near)


def _line_poses(line: Line) -> Array:
    """Return poses (N, 3) along the line, in the order of its pieces."""
    parts = []
    for piece in line.pieces:
        points = piece.at(np.linspace(0.0, piece.length_m, 2 + int(piece.length_m / SPACING_M)))
        steps = np.gradient(points, axis=0)
        parts.append(np.column_stack([points, np.arctan2(steps[:, 1], steps[:, 0])]))
    return np.concatenate(parts)


def _nearest(poses: Array, spec: RunSpec) -> int:
    return int(np.argmin(np.hypot(poses[:, 0] - spec.start.x_m, poses[:, 1] - spec.start.y_m)))


def _contains(rectangle: Rectangle, poses: Array) -> np.ndarray:
    c, s = math.cos(rectangle.yaw_rad), math.sin(rectangle.yaw_rad)
    local = (poses[:, :2] - rectangle.center) @ np.array([[c, -s], [s, c]])
    return np.all(np.abs(local) <= 0.5 * np.array(rectangle.size), axis=1)
