"""A program of the user as the controller: one line of JSON to it and one back for each control tick, in lock-step.

docs/controllers.md describes the lines. The command is never part of a scenario, because reading a scenario, which may
come from a stranger, must not start a program.
"""

import json
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from configs.robot_controller import ControllerSettings
from configs.schema.base import disagreement
from physics.control.base import Command, Observation, RobotController, Twist, Voltages
from physics.control.pipe import Pipe
from symolo.core.errors import InputError, RunFailed, one_line
from symolo.dataset.codes import State
from symolo.dataset.tables.side_reading import first_fault

PROTOCOL = 1
"""Version of the lines."""
VARIABLE = "SYMOLO_CONTROLLER_COMMAND"
"""Environment variable with the command line of the program."""
_SHOWN_BYTES = 200
"""Length of the beginning of a wrong answer that a message shows."""
_STATES = {state.value for state in State}


@dataclass
class ChosenProgram:
    """The command line that the user gave for this process and its workers."""

    command: tuple[str, ...] = ()
    """Program and arguments; empty without a program."""

    def choose(self, text: str) -> None:
        """Take a command line such as `python3 my_controller.py --fast`.

        Raises:
            InputError: It is not one, or there is no such program.
        """
        what = "--controller-command"
        try:
            command = tuple(shlex.split(text))
        except ValueError as error:
            raise InputError(what, got=text, allowed="a command line", cure=f"close the quotes: {error}") from None
        if not command:
            raise InputError(what, got=text, allowed="a program with its arguments")
        if shutil.which(command[0]) is None:
            raise InputError(f"{what}: no such program", got=command[0], allowed="a program that can be executed")
        self.command = command

    def files(self) -> dict[int, Path]:
        """Return the files in the command line by their place, such as a script; not a program that PATH leads to."""
        return {place: Path(word) for place, word in enumerate(self.command) if Path(word).is_file()}


PROGRAM = ChosenProgram()


class ProgramSettings(ControllerSettings):
    """Limits on a program that controls the robot; `--controller-command` names the program."""

    answer_within_s: float = Field(default=5.0, gt=0, le=3600)
    """Longest time of the machine's clock until the answer to an observation [s]."""
    start_within_s: float = Field(default=30.0, gt=0, le=3600)
    """Longest time until the program has answered the first line, with the description of the robot [s]."""


class _Line(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


_LineForm = TypeVar("_LineForm", bound=_Line)


class _Ready(_Line):
    """The answer to the first line."""

    ready: bool


class _Answer(_Line):
    """The answer to an observation: a twist, or the voltages of both motors."""

    tick: int
    v_m_s: float | None = None
    w_rad_s: float | None = None
    right_V: float | None = None
    left_V: float | None = None
    state: int = 0

    @model_validator(mode="after")
    def _is_one_command(self) -> "_Answer":
        has_twist = [value is not None for value in (self.v_m_s, self.w_rad_s)]
        has_voltages = [value is not None for value in (self.right_V, self.left_V)]
        if not (all(has_twist) and not any(has_voltages)) and not (all(has_voltages) and not any(has_twist)):
            raise disagreement("", "other keys", "v_m_s and w_rad_s, or right_V and left_V")
        if self.state not in _STATES:
            raise disagreement("state", self.state, f"one of {', '.join(map(str, sorted(_STATES)))}")
        return self

    def command(self) -> Command:
        state = State(self.state)
        if self.v_m_s is not None and self.w_rad_s is not None:
            return Twist(self.v_m_s, self.w_rad_s, state)
        assert self.right_V is not None  # noqa: S101 - the validator has checked it
        assert self.left_V is not None  # noqa: S101 - as above
        return Voltages(self.right_V, self.left_V, state)


class Program(RobotController):
    """A program that reads observations and writes commands, one line of JSON each."""

    Settings = ProgramSettings

    def start(self) -> None:
        assert isinstance(self.settings, ProgramSettings)  # noqa: S101 - as `Settings` says
        self._tick = -1
        self._within_s = self.settings.answer_within_s
        self._pipe = Pipe(PROGRAM.command)
        seed = int(self.rng.integers(2**31))
        robot = self.robot.model_dump(mode="json")
        hello = {"symolo": PROTOCOL, "control_hz": self.control_hz, "seed": seed, "robot": robot}
        try:
            text = self._pipe.ask(json.dumps(hello), self.settings.start_within_s, "the first line")
            self._parsed(_Ready, text, "the first line")
        except BaseException:
            self.close()
            raise

    def step(self, seen: Observation) -> Command:
        self._tick += 1
        when = f"tick {self._tick} ({seen.t_s:.2f} s)"
        answer = self._parsed(_Answer, self._pipe.ask(_line(self._tick, seen), self._within_s, when), when)
        if answer.tick != self._tick:
            raise RunFailed(f"the controller answered {when} with an answer to tick {answer.tick}")
        return answer.command()

    def close(self) -> None:
        self._pipe.close()

    @staticmethod
    def _parsed(form: type[_LineForm], text: bytes, when: str) -> _LineForm:
        try:
            return form.model_validate_json(text)
        except ValidationError as error:
            shown = one_line(text[:_SHOWN_BYTES].decode(errors="replace"))
            raise RunFailed(f"the controller answered {when} with {shown!r}: {first_fault(error)}") from None


def _line(tick: int, seen: Observation) -> str:
    """Return the line for one tick. Python writes a float with all digits that it needs to be read back unchanged."""
    x_m, y_m, yaw_rad = seen.odometry
    observation = {
        "tick": tick,
        "t_s": seen.t_s,
        "line": seen.line,
        "front_m": seen.front_m,
        "left_m": seen.left_m,
        "right_m": seen.right_m,
        "odometry": {"x_m": x_m, "y_m": y_m, "yaw_rad": yaw_rad},
        "encoder_counts": seen.encoder_counts,
        "encoder_increments": seen.encoder_increments,
        "sensors": {name: np.asarray(reading).tolist() for name, reading in seen.sensors.items()},
    }
    return json.dumps(observation)
