"""Python files outside the project with effects and sensors: loaded here and in the processes that do the work."""

from configs.effects.registry import EFFECTS
from configs.schema.robot import RobotConfig
from sensors.registry import SENSORS
from symolo.core.files.file_hashes import sha256_of

FAMILIES = (EFFECTS, SENSORS)


def load_from_environment() -> None:
    """Load the files that `SYMOLO_EFFECT_FILES` and `SYMOLO_SENSOR_FILES` name, separated by colons.

    Raises:
        InputError: A file is missing, cannot be executed, or its class is not complete.
    """
    for family in FAMILIES:
        family.load_from_environment()


def environment() -> dict[str, str]:
    """Return the variables with which another process loads the files that are loaded here."""
    return {name: paths for family in FAMILIES for name, paths in family.environment().items()}


def hashes_of_files(robot: RobotConfig) -> dict[str, str]:
    """Return the SHA-256 of each loaded file that this robot needs, by the name of its effect or sensor."""
    needed = {effect.name for effect in robot.effects} | {*robot.sensors.names}
    files = {name: file for family in FAMILIES for name, file in family.files.items()}
    return {name: sha256_of(file.resolve()) for name, file in files.items() if name in needed}
