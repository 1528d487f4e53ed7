"""Who drives the robot: at each control tick readings go in and the set points of the wheels come out."""

from dataclasses import dataclass
from typing import Protocol

from configs.schema.robot import RobotConfig
from physics.control.base import Command, ControlInput
from physics.control.controller import RobotController


@dataclass(frozen=True)
class Decision:
    """What is done from this tick on."""

    command: Command
    wheels_rad_s: tuple[float, float]
    """Set points of the wheels, right and left."""
    line_lost: int
    """Ticks so far in the line state without any channel on the line."""
    board: tuple[int, ...] = ()
    """How a board did at this tick, as `hil.tally` counts; empty without one."""


class Pilot(Protocol):
    """Asked once a control tick, in order."""

    def decide(self, seen: ControlInput, turned: tuple[int, int]) -> Decision:
        """The decision for this tick; `turned` is by how many encoder counts right and left have turned since the last.

        Raises:
            RunFailed: There is nobody left who could decide.
        """
        ...


class BuiltInPilot:
    """The project's own controller, at once."""

    def __init__(self, robot: RobotConfig) -> None:
        self._controller = RobotController(robot.controller, robot.line_sensor.threshold)
        self._half_track_m, self._radius_m = 0.5 * robot.drive.track_m, 0.5 * robot.drive.wheel_diameter_m

    def decide(self, seen: ControlInput, turned: tuple[int, int]) -> Decision:  # noqa: ARG002 - odometry is in `seen`
        command = self._controller.step(seen)
        right_m_s = command.v_m_s + command.w_rad_s * self._half_track_m
        left_m_s = command.v_m_s - command.w_rad_s * self._half_track_m
        wheels_rad_s = (right_m_s / self._radius_m, left_m_s / self._radius_m)
        return Decision(command, wheels_rad_s, self._controller.line_lost_count)
