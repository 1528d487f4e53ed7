"""Room that a random arena leaves for the body of the scenario's robot."""

import math
from collections.abc import Iterator

from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from configs.validation.faults import ConfigFault

RESERVE = 0.1
"""Room on each side of the body that the control needs, as a share of the width of the body."""
NOMINAL_LENGTH_M, NOMINAL_WIDTH_M = 0.18, 0.17
"""Size of the robot for which the arena `random` is made."""


def generated_room_faults(arena: ArenaConfig, robot: RobotConfig) -> Iterator[ConfigFault]:
    """Yield the clearances of a random arena in which the body of the robot would touch something."""
    if arena.generate is None:
        return
    clearance, avoidance = arena.generate.clearance, robot.controller.avoidance
    length_m, width_m = robot.chassis.length_m, robot.chassis.width_m
    scale = math.ceil(100.0 * max(length_m / NOMINAL_LENGTH_M, width_m / NOMINAL_WIDTH_M)) / 100.0
    body = f"the body of the robot is {length_m:g} m long and {width_m:g} m wide"
    cure = f"scale the arena as the robot, such as `arena: {{extends: random, scale: {scale:g}}}`"
    limits = [("beside_m", (0.5 + RESERVE) * width_m, "half its width and a tenth of it")]
    if arena.generate.max_obstacles and avoidance.curves is None:
        passing_m = avoidance.side_m + 0.5 * math.hypot(length_m, width_m)
        limits.append(("passing_m", passing_m, f"the {avoidance.side_m:g} m of its path and half its diagonal"))
    for name, needed_m, what in limits:
        if (got := getattr(clearance, name)) < needed_m:
            yield ConfigFault(
                ("arena", "generate", "clearance", name),
                f"too little room: {body}",
                got,
                f"at least {needed_m:.3f}, {what}",
                against=("robot", "chassis", "width_m"),
                also=(("robot", "chassis", "length_m"), ("robot", "controller", "avoidance", "side_m")),
                cure=cure,
            )
