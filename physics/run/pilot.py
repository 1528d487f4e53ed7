"""The pilot drives the robot: at each control tick it gets readings and returns the set points of the wheels."""

from dataclasses import dataclass
from typing import Protocol

from configs.schema.robot import RobotConfig
from physics.control.base import Command, ControlInput
from physics.control.controller import RobotController


@dataclass(frozen=True)
class Decision:
    """What the robot does from this tick on."""

    command: Command
    wheels_rad_s: tuple[float, float]
    """Set points [rad/s] of the wheels, right and left."""
    line_lost: int
    """Number of ticks so far in the line state without any channel on the line."""
    board: tuple[int, ...] = ()
    """Counts of the events of a board at this tick, as of `hil.pilot.event_counts`; empty without a board."""


class Pilot(Protocol):
    """Decides once a control tick, in order."""

    def decide(self, seen: ControlInput, turned: tuple[int, int]) -> Decision:
        """Return the decision for this tick; `turned` is the change of the encoder counts, right and left, since the
        last one.

        Raises:
            RunFailed: The pilot cannot decide any more.
        """
        ...


class BuiltInPilot:
    """The built-in controller, which decides at once."""

    def __init__(self, robot: RobotConfig) -> None:
        self._controller = RobotController(robot.controller, robot.line_sensor.threshold)
        self._half_track_m, self._radius_m = 0.5 * robot.drive.track_m, 0.5 * robot.drive.wheel_diameter_m

    def decide(self, seen: ControlInput, turned: tuple[int, int]) -> Decision:  # noqa: ARG002 - odometry is in `seen`
        command = self._controller.step(seen)
        right_m_s = command.v_m_s + command.w_rad_s * self._half_track_m
        left_m_s = command.v_m_s - command.w_rad_s * self._half_track_m
        wheels_rad_s = (right_m_s / self._radius_m, left_m_s / self._radius_m)
        return Decision(command, wheels_rad_s, self._controller.line_lost_count)
