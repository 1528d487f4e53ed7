"""The pose that an external camera logs; a run has this series only if an effect of the robot acts on it."""

from dataclasses import dataclass

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from physics.robot.model import applied
from sensors.base import Sampling, Sensor, World
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.column import Series

HEADING = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, kw_only=True)
class _DelayedSampling(Sampling):
    """Sampling with a delay that may change during the run."""

    effects: RobotEffects
    physics_hz: int

    @classmethod
    def from_effects(cls, effects: RobotEffects, physics_hz: int) -> "_DelayedSampling":
        return cls(period_steps=1, delay_steps=0, effects=effects, physics_hz=physics_hz)

    def step_read_at(self, step: int) -> int:
        delay_s = applied(self.effects.functions(Slot.POSE_DELAY), 0.0, step / self.physics_hz)
        return max(0, step - round(delay_s * self.physics_hz))


class PoseLog(Sensor):
    """Pose (3,) of the tracked point: x [m], y [m], yaw [rad]; the log delays it by whole physics steps."""

    name = "pose_log"
    series = (Series("pose_log", "m, m, rad"),)

    def __init__(self, effects: RobotEffects, physics_hz: int) -> None:
        self.sampling = _DelayedSampling.from_effects(effects, physics_hz)
        self._point = effects.functions(Slot.POSE_POINT)
        self._heading = effects.functions(Slot.POSE_HEADING)

    @classmethod
    def on_robot(cls, robot: RobotConfig, arena: Arena, physics_hz: int, rng: np.random.Generator) -> "PoseLog | None":
        """Return the log if an effect of the robot acts on it; without one, the log would be the true pose."""
        del arena, rng
        acts = robot.effects.in_slots({Slot.POSE_POINT, Slot.POSE_HEADING, Slot.POSE_DELAY})
        return cls(robot.effects, physics_hz) if acts else None

    def sample(self, world: World) -> Array:
        pose = applied(self._point, np.array(world.pose()))
        error_rad = applied(self._heading, np.zeros(()), np.array(world.pose()[2]), world.time_s)
        return pose + error_rad * HEADING if self._heading else pose
