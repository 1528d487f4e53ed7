"""Runners of controllers: at each control tick a runner gets an observation and decides what the wheels do."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from configs.effects.robot_effects import RobotEffects
from configs.families import last_call
from configs.robot_controller import ChosenController, ControllerSettings
from configs.schema.robot import RobotConfig
from physics.control.base import Command, Observation, RobotController, Twist, Voltages
from physics.control.built_in import BuiltIn
from physics.control.program import PROGRAM, Program
from physics.control.registry import CONTROLLERS
from physics.drivetrain.motor import MotorModel
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed, nearest, one_line, shown
from symolo.dataset.codes import State

MAX_NUMBER = 1000.0
"""Largest speed [m/s, rad/s] or voltage [V] of a command; a larger one is a mistake of the controller."""


@dataclass(frozen=True)
class Decision:
    """What the robot does from this tick on."""

    command: Twist
    """Commanded motion; with voltages, the motion that they lead to without load."""
    wheels_rad_s: tuple[float, float]
    """Set points [rad/s] of the wheels, right and left; with voltages, the speeds without load."""
    line_lost: int
    """Number of ticks so far in the line state without any channel on the line."""
    board: tuple[int, ...] = ()
    """Counts of the events of a board at this tick, as of `hil.board_runner.event_counts`; empty without a board."""
    voltages_V: tuple[float, float] | None = None
    """Voltages of the motors, right and left, in place of the wheel loops."""


class ControllerRunner(Protocol):
    """Runs a controller, in this process or on a board: one decision for each control tick, in order."""

    def decide(self, seen: Observation) -> Decision:
        """Return the decision for this tick.

        Raises:
            RunFailed: The controller cannot decide any more.
        """
        ...


class DriveKinematics:
    """Converts commands to set points or voltages of the wheels of one robot."""

    def __init__(self, robot: RobotConfig) -> None:
        self._half_track_m, self._radius_m = 0.5 * robot.drive.track_m, 0.5 * robot.drive.wheel_diameter_m
        self._motor = MotorModel.from_config(robot.motor)

    def decision(self, command: Command, line_lost: int = 0) -> Decision:
        """Return the decision that carries out a command, with the ticks so far without a visible line."""
        if isinstance(command, Voltages):
            voltages_V = (command.right_V, command.left_V)
            right, left = (self._motor.steady_state(voltage_V)[1] for voltage_V in voltages_V)
            v_m_s = 0.5 * self._radius_m * (right + left)
            w_rad_s = 0.5 * self._radius_m * (right - left) / self._half_track_m
            twist = Twist(v_m_s, w_rad_s, command.state)
            return Decision(twist, (right, left), line_lost, voltages_V=voltages_V)
        right_m_s = command.v_m_s + command.w_rad_s * self._half_track_m
        left_m_s = command.v_m_s - command.w_rad_s * self._half_track_m
        return Decision(command, (right_m_s / self._radius_m, left_m_s / self._radius_m), line_lost)


class InProcessRunner:
    """Runs a controller in this process, where it decides at once. Its mistakes end the run with a message."""

    def __init__(self, controller: RobotController) -> None:
        self._controller = controller
        self._kinematics = DriveKinematics(controller.robot)

    @classmethod
    def from_robot(
        cls, robot: RobotConfig, control_hz: int, rng: np.random.Generator, chosen: ChosenController | None = None
    ) -> "InProcessRunner":
        """Return a runner with the controller of a run.

        Args:
            robot: The robot of the run.
            control_hz: Rate of the decisions.
            rng: Random stream of the controller.
            chosen: The controller of the scenario; None for the built-in one.

        Raises:
            InputError: The class of the controller is not loaded.
            RunFailed: The controller cannot start.
        """
        # A controller knows the description of its robot, and not the effects.
        nominal = robot.model_copy(update={"effects": RobotEffects()})
        kind = BuiltIn if chosen is None else controller_class(chosen)
        settings = ControllerSettings() if chosen is None else chosen.settings
        if not isinstance(settings, ControllerSettings):
            raise InputError(f"controller.{kind.name}", cure="read the scenario with the file of the controller loaded")
        with _explained(kind.name, "at the start"):
            return cls(kind(settings, nominal, control_hz, rng))

    def decide(self, seen: Observation) -> Decision:
        name, when = self._controller.name, f"at {seen.t_s:.2f} s"
        with _explained(name, when):
            command = self._controller.step(seen)
        if problem := _problem(command):
            raise RunFailed(f"controller {name} {when}: {problem}")
        return self._kinematics.decision(command, self._controller.line_lost_count)

    def close(self) -> None:
        self._controller.close()


def controller_class(chosen: ChosenController) -> type[RobotController]:
    """Return the class of a controller.

    Raises:
        InputError: It is not loaded.
    """
    known = CONTROLLERS.by_name()
    if chosen.name not in known:
        cure = "name its file before the command: symolo --controller-file FILE ..."
        raise InputError(
            f"controller.{chosen.name}: no such controller", nearest=nearest(chosen.name, known), cure=cure
        )
    if chosen.name == Program.name and not PROGRAM.command:
        cure = 'name it before the command: symolo --controller-command "python3 my_controller.py" ...'
        raise InputError("controller.program: no program", cure=cure)
    return known[chosen.name]


def _problem(command: object) -> str:
    """Return what is wrong with the result of a controller's step; empty where nothing is."""
    if not isinstance(command, Twist | Voltages):
        return f"step returned {shown(command)}, allowed: Twist or Voltages"
    for name, value in vars(command).items():
        if name == "state":
            continue
        if not isinstance(value, int | float | np.floating | np.integer) or not abs(value) <= MAX_NUMBER:
            return f"{name} is {shown(value)}, allowed: a number from {-MAX_NUMBER:g} to {MAX_NUMBER:g}"
    if not isinstance(command.state, State):
        return f"state is {shown(command.state)}, allowed: State.{', State.'.join(State.__members__)}"
    return ""


@contextmanager
def _explained(name: str, when: str) -> Iterator[None]:
    """End the run with a message at an error in a class of the user; an error in a class of this project is a bug."""
    try:
        yield
    except (InputError, RunFailed, EnvironmentLacking):
        raise
    except Exception as error:
        file = CONTROLLERS.files.get(name)
        if file is None:
            raise
        call = last_call(error, file.path)
        place = f"{file.path.name}:{call.lineno}" if call else file.path.name
        raise RunFailed(one_line(f"controller {name} {when}: {place}: {type(error).__name__}: {error}")) from error
