"""The table of all controllers: those of the project, and those of files that a user loads."""

import re

from configs.families import Family
from configs.robot_controller import ControllerSettings
from physics.control.base import RobotController
from physics.control.program import PROGRAM, Program
from symolo.core.errors import InputError
from symolo.dataset.layout import NAME_PATTERN


def settings_by_name() -> tuple[tuple[str, type[ControllerSettings]], ...]:
    """Return name and settings of each controller that the key `controller` may name."""
    return tuple((controller.name, controller.Settings) for controller in CONTROLLERS.classes())


def _check(controller: type[RobotController], where: str) -> None:
    what = f"controller {controller.name}"
    if not re.fullmatch(NAME_PATTERN, controller.name):
        allowed = "letters, digits, '_' and '-', at most 64"
        raise InputError(f"{what}: name", where=where, got=controller.name, allowed=allowed)
    if getattr(controller.step, "__isabstractmethod__", False):
        cure = "define step(self, seen), which returns Twist(v_m_s, w_rad_s) or Voltages(right_V, left_V)"
        raise InputError(f"{what}: step missing", where=where, cure=cure)
    if not issubclass(controller.Settings, ControllerSettings):
        cure = "write class Settings(ControllerSettings): ..."
        raise InputError(f"{what}: Settings does not derive from ControllerSettings", where=where, cure=cure)


def names_from_command_line() -> tuple[str, ...]:
    """Return the names of the controllers of loaded files, and that of the program if there is one."""
    return (*CONTROLLERS.files, *((Program.name,) if PROGRAM.command else ()))


CONTROLLERS: Family[RobotController] = Family(
    "controller", RobotController, "CONTROLLERS", ("physics.control",), _check
)
"""All controllers; those of loaded files come last."""
