"""The sensors of a robot, each on its own random stream, and their tables."""

from collections.abc import Callable, Iterator

import numpy as np

from configs.robot_sensors import RobotSensors, SensorSettings, UnloadedSettings
from configs.schema.robot import RobotConfig
from configs.user_files import SENSOR_FILES
from configs.validation.schema_faults import OWN_SENSOR
from sensors.base import Sensor
from sensors.registry import SENSORS
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError, nearest
from symolo.dataset.tables.sensor_tables import ListedSensor

_STATES = ", which states how its readings come about and what their columns are"


def build_sensors(
    robot: RobotConfig, arena: Arena, physics_hz: int, rng_of: Callable[[str], np.random.Generator]
) -> dict[str, Sensor]:
    """Build every sensor of a robot, each with the random stream of its name.

    Raises:
        InputError: The class of a sensor of `robot.sensors` is not loaded.
    """
    listed = list(_listed(robot))
    standard_kinds = (kind for kind in SENSORS.classes() if not kind.is_listed())
    built = {kind.name: kind.on_robot(robot, arena, physics_hz, rng_of(kind.name)) for kind in standard_kinds}
    built |= {name: kind(settings, arena, physics_hz, rng_of(name)) for name, kind, settings in listed}
    return {name: sensor for name, sensor in built.items() if sensor is not None}


def listed_sensors(robot: RobotConfig) -> tuple[ListedSensor, ...]:
    """Return the sensors of `robot.sensors` with their tables.

    Raises:
        InputError: The class of a sensor is not loaded, or its file has changed since the data were made.
    """
    return tuple(ListedSensor(kind.name, kind.table(name, settings)) for name, kind, settings in _listed(robot))


def with_loaded_sensors(robot: RobotConfig) -> tuple[RobotConfig, dict[str, InputError]]:
    """Return the robot with those of `robot.sensors` whose classes are loaded, and why the others cannot be built."""
    loaded: list[tuple[str, SensorSettings | UnloadedSettings]] = []
    problems: dict[str, InputError] = {}
    for name, settings in robot.sensors:
        try:
            listed_sensors(robot.model_copy(update={"sensors": RobotSensors(((name, settings),))}))
            loaded.append((name, settings))
        except InputError as error:
            problems[name] = error
    return robot.model_copy(update={"sensors": RobotSensors(tuple(loaded))}), problems


def _listed(robot: RobotConfig) -> Iterator[tuple[str, type[Sensor], SensorSettings]]:
    """Yield name, class and settings of each sensor of `robot.sensors` except the cameras."""
    known = {kind.name: kind for kind in SENSORS.classes() if kind.is_listed()}
    problems = {file.name: problem for file in robot.sensor_files if (problem := SENSOR_FILES.problem(file, _STATES))}
    for name, settings in robot.sensors:
        if problem := problems.get(settings.kind or name):
            raise problem
        kind = known.get(settings.kind or name)
        if kind is None or not isinstance(settings, SensorSettings):
            got, hint = settings.kind or name, nearest(settings.kind or name, [*known])
            raise InputError(f"robot.sensors.{name}: no such kind of sensor", got=got, nearest=hint, cure=OWN_SENSOR)
        if not kind.is_rendered:
            yield name, kind, settings
