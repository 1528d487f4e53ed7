"""The user's own code: files with effects, sensors and controllers, and the program that controls the robot.

It is loaded here and in the processes that do the work.
"""

import os
import shlex
from collections.abc import Iterator

from configs.effects.registry import EFFECTS
from configs.schema.scenario import RunSpec
from physics.control.program import PROGRAM, VARIABLE, Program
from physics.control.registry import CONTROLLERS
from sensors.registry import SENSORS
from symolo.core.errors import InputError
from symolo.core.files.file_hashes import sha256_of

FAMILIES = (EFFECTS, SENSORS, CONTROLLERS)


def load_from_environment() -> None:
    """Load the files that `SYMOLO_EFFECT_FILES`, `SYMOLO_SENSOR_FILES` and `SYMOLO_CONTROLLER_FILES` name, separated by
    colons, and take the program of `SYMOLO_CONTROLLER_COMMAND`.

    Raises:
        InputError: A file is missing, cannot be executed, or its class is not complete; or there is no such program.
    """
    for family in FAMILIES:
        family.load_from_environment()
    if command := os.environ.get(VARIABLE):
        PROGRAM.choose(command)


def fault_of_user_code(error: Exception) -> InputError | None:
    """Return the message for an error that code of a loaded file led to; None where it is a bug of this project."""
    return next((fault for family in FAMILIES if (fault := family.fault_of(error))), None)


def environment() -> dict[str, str]:
    """Return the variables with which another process loads the same."""
    files = {name: paths for family in FAMILIES for name, paths in family.environment().items()}
    return files | ({VARIABLE: shlex.join(PROGRAM.command)} if PROGRAM.command else {})


def hashes_of_files(spec: RunSpec) -> dict[str, str]:
    """Return the SHA-256 of each file of the controller of this run.

    The specification itself has those of its effects and sensors.
    """
    hashes: dict[str, str] = {}
    if spec.controller is None:
        return hashes
    if spec.controller.name == Program.name:  # its command line as well
        hashes |= {f"{Program.name}.{place}": word for place, word in enumerate(PROGRAM.command)}
    return hashes | hashes_of_controller(spec.controller.name)


def not_loaded(spec: RunSpec) -> Iterator[str]:
    """Yield a message for each sensor and controller of a run whose class is not loaded."""
    for kind in sorted(spec.robot.sensors.kinds - SENSORS.by_name().keys()):
        yield f"sensor {kind} is not loaded; name its file: symolo --sensor-file FILE ..."
    if spec.controller is None:
        return
    if spec.controller.name not in CONTROLLERS.by_name():
        yield f"controller {spec.controller.name} is not loaded; name its file: symolo --controller-file FILE ..."
    elif spec.controller.name == Program.name and not PROGRAM.command:
        yield "the program that controls the robot is not known; name it: symolo --controller-command COMMAND ..."


def hashes_of_controller(name: str) -> dict[str, str]:
    """Return the SHA-256 of the file of a controller; a program has one for each file in its command line."""
    if name == Program.name:
        return {f"{name}.{place}": sha256_of(file.resolve()) for place, file in PROGRAM.files().items()}
    file = CONTROLLERS.files.get(name)
    return {name: sha256_of(file.path)} if file else {}
