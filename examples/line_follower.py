"""A controller that follows the line, in place of the built-in one.

symolo --controller-file examples/line_follower.py simulate smoke --set "arena.obstacles=[]" --out data
"""

from pydantic import Field

from physics.control.base import ControllerSettings, Observation, RobotController, Twist


class LineFollower(RobotController):
    """Turn towards the line in proportion to its offset, and drive more slowly where it is far off."""

    class Settings(ControllerSettings):
        speed_m_s: float = Field(default=0.18, gt=0, le=1)
        """Speed on a straight line."""
        gain_rad_s: float = Field(default=0.9, ge=0, le=10)
        """Yaw rate per channel of offset."""

    def start(self) -> None:
        self.offset = 0.0

    def step(self, seen: Observation) -> Twist:
        threshold = self.robot.line_sensor.threshold
        dark = [channel - 3.5 for channel, reflectance in enumerate(seen.line) if reflectance < threshold]
        if dark:  # without a dark channel the line is where it was
            self.offset = sum(dark) / len(dark)
        else:
            self.line_lost_count += 1
        v_m_s = self.settings.speed_m_s * (1.0 - abs(self.offset) / 7.0)
        return Twist(v_m_s, self.settings.gain_rad_s * self.offset)
