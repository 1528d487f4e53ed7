"""Checks of the paths of moving obstacles: times, speeds, and collisions with fixed things."""

import math
from collections.abc import Iterator
from itertools import pairwise

from configs.schema.arena import ArenaConfig, Obstacle
from configs.validation.faults import ConfigFault
from symolo.arena.footprints import obstacle_footprint, outlines_overlap, stations, swept, wall_footprint
from symolo.core.yaml.tree import FieldPath

MAX_SPEED_M_S = 2.0
"""Ten times the robot's speed, and 2 mm per step at 1000 Hz."""
MAX_SPEED_DEG_S = 360.0
LARGE_M = 3.0
"""Size of an obstacle from which on a message states it, because it is probably in cm."""


def motion_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    """Yield all faults of the arena's paths. Collisions between two moving obstacles are not checked."""
    for index, obstacle in enumerate(arena.obstacles):
        if obstacle.motion is None:
            continue
        path: FieldPath = ("arena", "obstacles", index, "motion")
        timing = list(_time_faults(obstacle, path))
        yield from timing
        if timing:
            continue  # speeds need times in order
        yield from _speed_faults(obstacle, path)
        yield from _closing_faults(obstacle, path)
        yield from _floor_faults(obstacle, path, arena.floor.half_extent_m)
        yield from _collision_faults(obstacle, path, arena)


def _waypoint(path: FieldPath, index: int) -> FieldPath:
    return (*path, "waypoints", index)


def _time_faults(obstacle: Obstacle, path: FieldPath) -> Iterator[ConfigFault]:
    times = [time_s for time_s, _ in stations(obstacle)][1:]
    for index, (before, after) in enumerate(pairwise(times)):
        if after <= before:
            at, against = (*_waypoint(path, index + 1), "t_s"), (*_waypoint(path, index), "t_s")
            yield ConfigFault(
                at, "times must increase", after, f"more than {before:g}, the time before it", against=against
            )


def _speed_faults(obstacle: Obstacle, path: FieldPath) -> Iterator[ConfigFault]:
    for index, ((t0, a), (t1, b)) in enumerate(pairwise(stations(obstacle))):
        metres, degrees = math.dist(a.center, b.center), math.degrees(abs(b.yaw_rad - a.yaw_rad))
        for field, distance, max_speed, unit in (
            ("offset", metres, MAX_SPEED_M_S, "m"),
            ("turn_deg", degrees, MAX_SPEED_DEG_S, "deg"),
        ):
            if distance > max_speed * (t1 - t0) * (1 + 1e-9):
                cure = f"allow at least {distance / max_speed:.3g} s for the {distance:.3g} {unit}"
                allowed = f"at most {max_speed:g} {unit}/s"
                got = f"{distance / (t1 - t0):.3g} {unit}/s"
                yield ConfigFault((*_waypoint(path, index), field), "too fast", got, allowed, cure=cure)


def _closing_faults(obstacle: Obstacle, path: FieldPath) -> Iterator[ConfigFault]:
    if obstacle.motion is None or obstacle.motion.repeat != "loop":
        return
    last = obstacle.motion.waypoints[-1]
    turn_deg = math.remainder(last.turn_deg, 360.0)
    if math.hypot(*last.offset) > 1e-9 or abs(turn_deg) > 1e-9:
        at = _waypoint(path, len(obstacle.motion.waypoints) - 1)
        allowed = "offset [0, 0] and whole turns in the last waypoint, or the obstacle would jump back to its start"
        got = [*last.offset, last.turn_deg]
        yield ConfigFault(at, "the loop is not closed", got, allowed, cure="or take repeat: back_and_forth")


def _floor_faults(obstacle: Obstacle, path: FieldPath, limit_m: float) -> Iterator[ConfigFault]:
    for index, (_, place) in enumerate(stations(obstacle)[1:]):
        if max(map(abs, place.center)) > limit_m:
            allowed = f"places on the floor, within {limit_m} m of the origin along x and y"
            cure = "move it or enlarge arena.floor.half_extent_m"
            at = (*_waypoint(path, index), "offset")
            yield ConfigFault(at, "leads beyond the edge of the floor", place.center, allowed, cure=cure)


def sized_name(obstacle: Obstacle) -> str:
    """Return the name of an obstacle for messages, with its size if that is larger than usual, probably in cm."""
    length_m, width_m, height_m = obstacle.size
    shown = f" of {length_m:g} m x {width_m:g} m x {height_m:g} m (sizes are in metres)"
    size = shown if max(obstacle.size) >= LARGE_M else ""
    return f"obstacle {obstacle.name}{size}"


def _collision_faults(obstacle: Obstacle, path: FieldPath, arena: ArenaConfig) -> Iterator[ConfigFault]:
    walls = [(f"wall {w.name}", wall_footprint(w)) for w in arena.walls if math.dist(w.start, w.end) > 0]
    others = [o for o in arena.obstacles if o.motion is None]
    standing = walls + [(sized_name(o), obstacle_footprint(o)) for o in others]
    for index, ((_, a), (_, b)) in enumerate(pairwise(stations(obstacle))):
        outlines = swept(a, b)
        for name, body in standing:
            if any(outlines_overlap(body.corners(), outline) for outline in outlines):
                problem = f"the path leads through {name}"
                cure = "lead the path around it, or move it"
                yield ConfigFault(_waypoint(path, index), problem, b.center, cure=cure)
