"""The table of all sensors: those of the project, and those from files that a user loads."""

import re

from configs.families import Family
from configs.robot_sensors import SensorSettings
from sensors.base import Sensor
from symolo.core.errors import InputError
from symolo.dataset.tables.sensor_tables import SENSOR_NAME, TAKEN_NAMES, TIME


def settings_by_kind() -> tuple[tuple[str, str, type[SensorSettings]], ...]:
    """Return name, name of the class and settings of each kind of sensor that `robot.sensors` may contain."""
    return tuple(
        (kind.name, kind.__name__, kind.Settings)
        for kind in SENSORS.classes()
        if issubclass(kind.Settings, SensorSettings)
    )


def _check(sensor: type[Sensor], where: str) -> None:
    what = f"sensor {sensor.name}"
    if getattr(sensor.sample, "__isabstractmethod__", False):
        cure = "define sample(self, world), which returns one number for each column"
        raise InputError(f"{what}: sample missing", where=where, cure=cure)
    if not issubclass(sensor.Settings, SensorSettings):
        return  # every robot has it; its columns are in data.csv and in tables that are written one by one
    if sensor.is_rendered:
        return
    if not re.fullmatch(SENSOR_NAME, sensor.name) or sensor.name in TAKEN_NAMES:
        allowed = f"a name other than {', '.join(sorted(TAKEN_NAMES))}"
        raise InputError(f"{what}: the name is taken by another file of side/", where=where, allowed=allowed)
    if sensor.columns_of.__func__ is not Sensor.columns_of.__func__:
        return  # they depend on the settings
    columns = [column.name for column in sensor.columns]
    if not columns:
        cure = 'write, for example, columns = (Column("contact", "-", 0, "1 where something touches"),)'
        raise InputError(f"{what}: columns missing", where=where, cure=cure)
    wrong = [c for i, c in enumerate(columns) if not re.fullmatch(r"[A-Za-z]\w*", c) or c in (TIME.name, *columns[:i])]
    if wrong:
        allowed = f"letters, digits and '_', each name once, and not {TIME.name}, which is the time"
        raise InputError(f"{what}: columns", where=where, got=wrong[0], allowed=allowed)


SENSORS: Family[Sensor] = Family("sensor", Sensor, "SENSORS", ("sensors",), _check)
"""All sensors in the order of their table; those of loaded files, which `robot.sensors` may contain, come last."""
