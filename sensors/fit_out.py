"""The sensors of a robot, each on its own random stream."""

from collections.abc import Callable

import numpy as np

from configs.schema.robot import RobotConfig
from sensors.base import Sensor
from sensors.encoders import WheelEncoders
from sensors.line_sensor import LineSensorModel
from sensors.pose_log import PoseLog, logs_pose
from sensors.tof import TofArray
from symolo.arena.geometry import Arena

SENSORS: dict[str, Callable[[RobotConfig, Arena, int, np.random.Generator], Sensor]] = {
    "line": lambda robot, arena, physics_hz, rng: LineSensorModel(robot.line_sensor, arena, physics_hz, rng),
    "tof": lambda robot, arena, physics_hz, rng: TofArray(robot.tof, arena, physics_hz, rng, robot.effects),
    "encoders": lambda robot, _arena, physics_hz, rng: WheelEncoders(robot.encoder, physics_hz, rng),
}
"""Sensor by name; the name is also the last part of its random stream's path."""


def fit_out(
    robot: RobotConfig, arena: Arena, physics_hz: int, rng_of: Callable[[str], np.random.Generator]
) -> dict[str, Sensor]:
    """Build every sensor, each with the random stream of its name, and a pose log where an effect speaks of one."""
    sensors = {name: build(robot, arena, physics_hz, rng_of(name)) for name, build in SENSORS.items()}
    if logs_pose(robot.effects):
        sensors["pose_log"] = PoseLog(robot.effects, physics_hz)
    return sensors
