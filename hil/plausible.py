"""What a command must be like to be obeyed, which damage that a checksum misses seldom is."""

import math
from dataclasses import dataclass, field

from configs.schema.robot import RobotConfig
from hil.frames import MAX_INCREMENT, CommandFrame
from symolo.core.errors import InputError

TICKS_MOST = 65535
"""At which the board's count of frames stays."""
_HALF_LAST_DIGIT = 0.0005
"""Of a speed on the wire, in m/s and rad/s."""
_FASTER = 1.5
"""Set points beyond what the motor can do by this factor are damage."""


@dataclass(frozen=True)
class DriveLimits:
    """The drive as far as commands are judged by it."""

    wheel_rad_s: float
    wheel_radius_m: float
    track_m: float

    @classmethod
    def from_robot(cls, robot: RobotConfig) -> "DriveLimits":
        """Limits at the speed without load, at which back-EMF is the whole voltage."""
        return cls(_FASTER * _no_load_rad_s(robot), 0.5 * robot.drive.wheel_diameter_m, robot.drive.track_m)

    def twist(self, command: CommandFrame) -> tuple[float, float]:
        """Forward speed [m/s] and yaw rate [rad/s] of the set points (paper Eq. 1-2)."""
        right_m_s, left_m_s = self.wheel_radius_m * command.right_rad_s, self.wheel_radius_m * command.left_rad_s
        return 0.5 * (right_m_s + left_m_s), (right_m_s - left_m_s) / self.track_m

    def refusal(self, command: CommandFrame) -> str:
        """Why such a command is not obeyed; empty where it is.

        Set points are of the speeds that come with them, or both 0, for a board that stands still on purpose.
        """
        right, left = command.right_rad_s, command.left_rad_s
        if max(abs(right), abs(left)) > self.wheel_rad_s:
            return f"set points {right:g} and {left:g} rad/s, the wheels reach {self.wheel_rad_s:.1f}"
        if command.v_m_s is None or command.w_rad_s is None or right == left == 0.0:
            return ""
        half_track_m = 0.5 * self.track_m
        # Both sides are rounded to the last digit of the wire, and the board reckons in single precision.
        spare = 2.0 * _HALF_LAST_DIGIT * (1.0 + (1.0 + half_track_m) / self.wheel_radius_m)
        for set_point, side in ((right, 1.0), (left, -1.0)):
            asked = (command.v_m_s + side * command.w_rad_s * half_track_m) / self.wheel_radius_m
            if abs(set_point - asked) > spare:
                speeds = f"{command.v_m_s:g} m/s and {command.w_rad_s:g} rad/s"
                return f"set points {right:g} and {left:g} rad/s are not those of {speeds}"
        return ""


def check_encoders(robot: RobotConfig, tick_s: float) -> None:
    """See to it that a frame holds what the encoders count in a tick of `tick_s`.

    Raises:
        InputError: They are too fine.
    """
    most = int(MAX_INCREMENT / (_no_load_rad_s(robot) * tick_s / math.tau))
    counts = robot.encoder.counts_per_revolution
    if counts > most:
        allowed = f"at most {most} for a controller on a board, whose frames hold {MAX_INCREMENT} counts a tick"
        raise InputError("robot.encoder.counts_per_revolution", got=counts, allowed=allowed)


def _no_load_rad_s(robot: RobotConfig) -> float:
    return robot.power.motor_voltage_limit_V / robot.motor.torque_constant_N_m_A


@dataclass
class TickCount:
    """What the board's count of frames says: which it took, and whether it has started afresh."""

    _last: int | None = None
    _unanswered: list[tuple[int, int]] = field(default_factory=list)
    """Encoder increments of the frames since the last answer."""
    _lost: tuple[int, int] = (0, 0)

    def owed(self, increments: tuple[int, int]) -> tuple[int, int]:
        """The increments with those that the board has missed, as many as a frame holds; the rest comes later."""
        right, left = increments[0] + self._lost[0], increments[1] + self._lost[1]
        told = _held(right), _held(left)
        self._lost = (right - told[0], left - told[1])
        return told

    def sent(self, increments: tuple[int, int]) -> None:
        self._unanswered.append(increments)

    def refusal(self, command: CommandFrame) -> str:
        """Why the count cannot be that of a good answer; empty where it can."""
        ticks, last = command.ticks, self._last
        if ticks is None or last is None:
            return ""
        most = len(self._unanswered)
        if last < ticks <= last + most or ticks <= most or ticks == last == TICKS_MOST:
            return ""
        return f"the board counts {ticks} frames after {last}, and {most} were sent"

    def answered(self, command: CommandFrame) -> bool:
        """Take note of a good answer to the last frame.

        Returns:
            Whether the board has started afresh since the last one.
        """
        ticks, last = command.ticks, self._last
        unanswered, self._unanswered, self._last = self._unanswered, [], ticks
        if ticks is None or last is None:
            return False
        if ticks <= last:
            return last < TICKS_MOST
        earlier, missed = unanswered[:-1], len(unanswered) - (ticks - last)
        if missed > 0 and last < TICKS_MOST:
            # Which of them it missed is not known where it missed some only; they are taken to be alike.
            share = missed / len(earlier)
            right, left = (round(share * sum(side)) for side in zip(*earlier, strict=True))
            self._lost = (self._lost[0] + right, self._lost[1] + left)
        return False


def _held(increment: int) -> int:
    return max(-MAX_INCREMENT, min(MAX_INCREMENT, increment))
