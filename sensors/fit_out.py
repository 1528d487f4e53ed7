"""The sensors of a robot, each on its own random stream, and their tables."""

from collections.abc import Callable

import numpy as np

from configs.robot_sensors import RobotSensors
from configs.schema.robot import RobotConfig
from sensors.base import Sensor
from sensors.registry import SENSORS
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError, nearest
from symolo.dataset.tables.side_tables import SideTable


def fit_out(
    robot: RobotConfig, arena: Arena, physics_hz: int, rng_of: Callable[[str], np.random.Generator]
) -> dict[str, Sensor]:
    """Build every sensor of a robot, each with the random stream of its name.

    Raises:
        InputError: The class of a sensor of `robot.sensors` is not loaded.
    """
    sensor_tables(robot.sensors)
    built = {kind.name: kind.on_robot(robot, arena, physics_hz, rng_of(kind.name)) for kind in SENSORS.classes()}
    return {name: sensor for name, sensor in built.items() if sensor is not None}


def sensor_tables(sensors: RobotSensors) -> tuple[SideTable, ...]:
    """Return the tables of the sensors of `robot.sensors`.

    Raises:
        InputError: The class of a sensor is not loaded.
    """
    known = {kind.name: table for kind in SENSORS.classes() if (table := kind.table())}
    for name in sensors.names:
        if name not in known:
            cure = f"name its file in the environment variable {SENSORS.variable}"
            raise InputError(f"robot.sensors.{name}: no such sensor", nearest=nearest(name, [*known]), cure=cure)
    return tuple(known[name] for name in sensors.names)
