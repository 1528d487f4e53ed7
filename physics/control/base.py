"""Interface of a controller: what it observes and what it commands at each control tick.

The built-in controller, a class in a file of the user and a program at a pipe are all controllers of this kind.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from configs.families import name_in_lower_case
from configs.robot_controller import ControllerSettings
from configs.schema.robot import RobotConfig
from symolo.core.geometry.poses import PlanarPose
from symolo.dataset.codes import State

__all__ = ["Command", "ControllerSettings", "Observation", "RobotController", "Side", "State", "Twist", "Voltages"]

Side = Literal["left", "right"]
Reading = NDArray[np.float64] | NDArray[np.int64]
NO_READINGS: Mapping[str, Reading] = MappingProxyType({})


def opposite(side: Side) -> Side:
    return "right" if side == "left" else "left"


def sign_of(side: Side) -> float:
    """Return +1 for left and -1 for right, as y and yaw grow to the left."""
    return 1.0 if side == "left" else -1.0


@dataclass(frozen=True)
class Observation:
    """Everything that a controller learns at one control tick; the true pose is not a part of it."""

    line: tuple[float, ...]
    """(8,), normalised reflectance of the channels L0 to L7, from right to left."""
    front_m: float
    left_m: float
    right_m: float
    """Range [m] of each sensor; the configured no-target value if it sees nothing."""
    odometry: PlanarPose
    """Pose x [m], y [m], yaw [rad] by the odometry of the wheels, in the frame of the start."""
    t_s: float = 0.0
    """Time [s] since the start of the run."""
    encoder_counts: tuple[int, int] = (0, 0)
    """Counts of the encoders, right and left, since the start of the run."""
    encoder_increments: tuple[int, int] = (0, 0)
    """Change of these counts since the last tick."""
    sensors: Mapping[str, Reading] = field(default_factory=lambda: NO_READINGS)
    """Newest delivered reading of each sensor of `robot.sensors` by its name, in the order of its columns."""

    def side_m(self, side: Side) -> float:
        return self.left_m if side == "left" else self.right_m


@dataclass(frozen=True)
class Twist:
    """Motion that the wheel loops keep until the next tick."""

    v_m_s: float
    """Forward speed of the middle of the axle."""
    w_rad_s: float
    """Yaw rate, counter-clockwise positive."""
    state: State = State.LINE
    """State of the controller, for data.csv."""


@dataclass(frozen=True)
class Voltages:
    """Voltages of the motors until the next tick, without the wheel loops; the driver limits them."""

    right_V: float
    left_V: float
    state: State = State.LINE
    """State of the controller, for data.csv."""


Command = Twist | Voltages


class RobotController(ABC):
    """A controller of one run.

    A new class derives `Settings` from `ControllerSettings` and defines `step`, and `start` where it has something to
    prepare. Its settings are `controller.<name>` of a scenario.
    """

    name: ClassVar[str]
    """Name of the class in lower case with underscores (`WallHugger` is `wall_hugger`), unless a class sets another."""
    Settings: ClassVar[type[ControllerSettings]] = ControllerSettings
    """Settings in a scenario."""
    line_lost_count: int = 0
    """Number of ticks so far in which the controller followed a line without seeing it."""

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        if "name" not in vars(cls):
            cls.name = name_in_lower_case(cls)

    def __init__(
        self, settings: ControllerSettings, robot: RobotConfig, control_hz: int, rng: np.random.Generator
    ) -> None:
        """Build the controller of one run.

        Args:
            settings: The settings with their values in this run.
            robot: The robot as its description says; a controller does not know the robot's effects.
            control_hz: Number of ticks per second.
            rng: Random stream of this controller alone.
        """
        self.settings, self.robot, self.control_hz, self.rng = settings, robot, control_hz, rng
        self.start()

    def start(self) -> None:  # noqa: B027 - most controllers need nothing
        """Prepare for the first tick."""

    @abstractmethod
    def step(self, seen: Observation) -> Command:
        """Return what the robot does until the next tick; called once for each tick, in order."""

    def close(self) -> None:  # noqa: B027 - most controllers hold nothing
        """Release what the controller holds, such as a process; called once at the end of the run."""
