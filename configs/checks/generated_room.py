"""Room that a random arena leaves for the body of the scenario's robot."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median

from configs.schema.arena import ArenaConfig
from configs.schema.arena_generator import Clearance
from configs.schema.robot import RobotConfig
from configs.validation.faults import ConfigFault
from symolo.core.yaml.tree import FieldPath, dotted

RESERVE = 0.1
"""Room on each side of the body that the control needs, as a share of the width of the body."""
NOMINAL_LENGTH_M, NOMINAL_WIDTH_M = 0.18, 0.17
"""Size of the robot for which the arena `random` is made."""

_CLEARANCE: FieldPath = ("arena", "generate", "clearance")
_SIDE: FieldPath = ("robot", "controller", "avoidance", "side_m")
_TOLERANCE = 1e-5
"""Relative error of a scaled number, which is rounded."""


@dataclass(frozen=True)
class _Limit:
    """A clearance and the smallest value with which the robot touches nothing."""

    name: str
    got_m: float
    needed_m: float
    what: str
    """What the needed value consists of."""
    needs: str
    """What needs the room."""

    @property
    def scale(self) -> float:
        """Scale of the arena `random` with which this clearance is large enough."""
        return self.needed_m / getattr(Clearance(), self.name)


def generated_room_faults(arena: ArenaConfig, robot: RobotConfig) -> Iterator[ConfigFault]:
    """Yield the clearances of a random arena in which the body of the robot would touch something."""
    if arena.generate is None:
        return
    clearance = arena.generate.clearance
    limits = _limits(clearance, robot, has_obstacles=arena.generate.max_obstacles > 0)
    for limit in limits:
        if limit.got_m < limit.needed_m * (1.0 - _TOLERANCE):
            yield ConfigFault(
                (*_CLEARANCE, limit.name),
                f"too little room: {limit.needs}",
                limit.got_m,
                f"at least {_rounded_up(limit.needed_m, 3):g}, {limit.what}",
                against=("robot", "chassis", "width_m"),
                also=(("robot", "chassis", "length_m"), _SIDE),
                cure=_cure(limit, limits, clearance, robot),
            )


def _limits(clearance: Clearance, robot: RobotConfig, *, has_obstacles: bool) -> list[_Limit]:
    length_m, width_m, avoidance = robot.chassis.length_m, robot.chassis.width_m, robot.controller.avoidance
    body = f"the body of the robot is {length_m:g} m long and {width_m:g} m wide"
    what = "half its width and a tenth of it"
    limits = [_Limit("beside_m", clearance.beside_m, (0.5 + RESERVE) * width_m, what, body)]
    if has_obstacles and avoidance.curves is None:
        passing_m = avoidance.side_m + 0.5 * math.hypot(length_m, width_m)
        what = f"the {avoidance.side_m:g} m of its path and half its diagonal"
        needs = f"{body}, and its path past an obstacle is {avoidance.side_m:g} m beside the line"
        limits.append(_Limit("passing_m", clearance.passing_m, passing_m, what, needs))
    return limits


def _cure(limit: _Limit, limits: list[_Limit], clearance: Clearance, robot: RobotConfig) -> str:
    """Return what to do: scale the arena for a large body; else change the setting that causes the fault."""
    body = max(robot.chassis.length_m / NOMINAL_LENGTH_M, robot.chassis.width_m / NOMINAL_WIDTH_M)
    # A few clearances that the user wrote do not change the median.
    present = median(value / default for (_, value), (_, default) in zip(clearance, Clearance(), strict=True))
    scale = _rounded_up(max(body, *(each.scale for each in limits)), 2)
    scaling = f"scale the arena as the robot, such as `arena: {{extends: random, scale: {scale:g}}}`"
    setting = f"set {dotted((*_CLEARANCE, limit.name))} to {_rounded_up(limit.needed_m, 3):g} or more"
    if body <= present * (1.0 + _TOLERANCE):
        return ", or ".join(part for part in (setting, _narrower_path(limit, clearance, robot)) if part)
    is_scaled = math.isclose(limit.got_m, present * getattr(Clearance(), limit.name), rel_tol=_TOLERANCE)
    return scaling if is_scaled else f"{scaling}, and {setting}"


def _narrower_path(limit: _Limit, clearance: Clearance, robot: RobotConfig) -> str:
    """Return with which path past an obstacle the room is enough; empty if it would lead through the obstacle."""
    side_m = robot.controller.avoidance.side_m - (limit.needed_m - limit.got_m)
    if limit.name != "passing_m" or side_m < clearance.obstacle_reach_m + 0.5 * robot.chassis.width_m:
        return ""
    return f"{dotted(_SIDE)} to {math.floor(1000.0 * side_m) / 1000.0:g} or less"


def _rounded_up(value: float, digits: int) -> float:
    """Return the value rounded up; what exceeds the last digit by rounding errors alone is not counted."""
    steps = 10.0**digits
    return math.ceil(round(steps * value, 6)) / steps
