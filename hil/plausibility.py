"""Plausibility checks of commands: damage that the checksum misses seldom passes them."""

import math
from dataclasses import dataclass, field

from configs.schema.robot import RobotConfig
from hil.frames import MAX_INCREMENT, CommandFrame
from symolo.core.errors import InputError

MAX_TICKS = 65535
"""Value at which the board's count of frames stops."""
_HALF_LAST_DIGIT = 0.0005
"""Rounding error of a speed on the wire, in m/s and rad/s."""
_MARGIN = 1.5
"""Set points above the no-load speed times this factor count as damage."""


@dataclass(frozen=True)
class DriveLimits:
    """The numbers of the drive that commands are checked against."""

    wheel_rad_s: float
    wheel_radius_m: float
    track_m: float

    @classmethod
    def from_robot(cls, robot: RobotConfig) -> "DriveLimits":
        """Return limits from the no-load speed, at which the back-EMF equals the voltage."""
        return cls(_MARGIN * _no_load_rad_s(robot), 0.5 * robot.drive.wheel_diameter_m, robot.drive.track_m)

    def twist(self, command: CommandFrame) -> tuple[float, float]:
        """Return forward speed [m/s] and yaw rate [rad/s] of the set points (paper Eq. 1-2)."""
        right_m_s, left_m_s = self.wheel_radius_m * command.right_rad_s, self.wheel_radius_m * command.left_rad_s
        return 0.5 * (right_m_s + left_m_s), (right_m_s - left_m_s) / self.track_m

    def refusal(self, command: CommandFrame) -> str:
        """Return why a command is refused; empty for a good one.

        The set points must follow from the speeds that come with them, or both be 0 for a board that stops on purpose.
        """
        right, left = command.right_rad_s, command.left_rad_s
        if max(abs(right), abs(left)) > self.wheel_rad_s:
            return f"set points {right:g} and {left:g} rad/s, the wheels reach {self.wheel_rad_s:.1f}"
        if command.v_m_s is None or command.w_rad_s is None or right == left == 0.0:
            return ""
        half_track_m = 0.5 * self.track_m
        # Set points and speeds are rounded on the wire, and the board calculates in single precision.
        tolerance = 2.0 * _HALF_LAST_DIGIT * (1.0 + (1.0 + half_track_m) / self.wheel_radius_m)
        for set_point, sign in ((right, 1.0), (left, -1.0)):
            expected = (command.v_m_s + sign * command.w_rad_s * half_track_m) / self.wheel_radius_m
            if abs(set_point - expected) > tolerance:
                speeds = f"{command.v_m_s:g} m/s and {command.w_rad_s:g} rad/s"
                return f"set points {right:g} and {left:g} rad/s do not fit {speeds}"
        return ""


def check_encoders(robot: RobotConfig, tick_s: float) -> None:
    """Check that a frame can hold the encoder counts of a tick of `tick_s`.

    Raises:
        InputError: The encoders count too finely.
    """
    max_counts = int(MAX_INCREMENT / (_no_load_rad_s(robot) * tick_s / math.tau))
    counts = robot.encoder.counts_per_revolution
    if counts > max_counts:
        allowed = f"at most {max_counts} for a controller on a board, whose frames hold {MAX_INCREMENT} counts a tick"
        raise InputError("robot.encoder.counts_per_revolution", got=counts, allowed=allowed)


def _no_load_rad_s(robot: RobotConfig) -> float:
    return robot.power.motor_voltage_limit_V / robot.motor.torque_constant_N_m_A


@dataclass
class TickCount:
    """The board's count of received frames: it shows which frames were lost and whether the board re-booted."""

    _last: int | None = None
    _unanswered: list[tuple[int, int]] = field(default_factory=list)
    """Encoder increments of all frames since the last answer."""
    _lost: tuple[int, int] = (0, 0)

    def with_lost(self, increments: tuple[int, int]) -> tuple[int, int]:
        """Return the increments plus those of lost frames, as many as a frame holds; the rest follows later."""
        right, left = increments[0] + self._lost[0], increments[1] + self._lost[1]
        clipped = tuple(max(-MAX_INCREMENT, min(MAX_INCREMENT, increment)) for increment in (right, left))
        self._lost = (right - clipped[0], left - clipped[1])
        return clipped[0], clipped[1]

    def sent(self, increments: tuple[int, int]) -> None:
        self._unanswered.append(increments)

    def refusal(self, command: CommandFrame) -> str:
        """Return why the count of an answer is impossible; empty for a good one."""
        ticks, last = command.ticks, self._last
        if ticks is None or last is None:
            return ""
        sent = len(self._unanswered)
        # Larger by the frames since the last answer at most; or small, after a re-boot; or at its end.
        if last < ticks <= last + sent or ticks <= sent or ticks == last == MAX_TICKS:
            return ""
        return f"the board counts {ticks} frames after {last}, and {sent} were sent"

    def answered(self, command: CommandFrame) -> bool:
        """Take a good answer to the last frame, and return whether the board has re-booted since the answer before."""
        ticks, last = command.ticks, self._last
        unanswered, self._unanswered, self._last = self._unanswered, [], ticks
        if ticks is None or last is None:
            return False
        if ticks <= last:
            return last < MAX_TICKS
        earlier, missed = unanswered[:-1], len(unanswered) - (ticks - last)
        if missed > 0 and last < MAX_TICKS:
            # Which frames were lost is not known: each is assumed to hold the mean increment.
            share = missed / len(earlier)
            right, left = (round(share * sum(speeds)) for speeds in zip(*earlier, strict=True))
            self._lost = (self._lost[0] + right, self._lost[1] + left)
        return False
