"""The pose that an external camera logs; a series of a run only where the robot has an effect for it."""

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from physics.robot.model import through
from sensors.base import Sampling, Sensor, World
from symolo.core.arrays import Array


class PoseLog(Sensor):
    """x [m], y [m], yaw [rad] of the tracked point, (3,), as old as the log is late, to a physics step."""

    def __init__(self, effects: RobotEffects, physics_hz: int) -> None:
        delay_s = through(effects.functions(Slot.POSE_DELAY), 0.0)
        self.sampling = Sampling(period_steps=1, delay_steps=round(delay_s * physics_hz))
        self._point = effects.functions(Slot.POSE_POINT)

    def sample(self, world: World) -> Array:
        return through(self._point, np.array(world.pose()))


def logs_pose(effects: RobotEffects) -> bool:
    """Whether an effect says anything of the pose log."""
    return any(effects.functions(slot) for slot in (Slot.POSE_POINT, Slot.POSE_DELAY))
