"""The pose that an external camera logs; a series of a run only where the robot has a term for it."""

import numpy as np

from configs.schema.effects.table import Terms
from physics.effects.base import Slot, effects
from physics.robot.model import through
from sensors.base import Sampling, Sensor, World
from sensors.effects import SENSOR_TERMS
from symolo.core.arrays import Array


class PoseLog(Sensor):
    """x [m], y [m], yaw [rad] of the tracked point, (3,), as old as the log is late, to a physics step."""

    def __init__(self, terms: Terms, physics_hz: int) -> None:
        delay_s = through(effects(SENSOR_TERMS, terms, Slot.POSE_DELAY), 0.0)
        self.sampling = Sampling(period_steps=1, delay_steps=round(delay_s * physics_hz))
        self._point = effects(SENSOR_TERMS, terms, Slot.POSE_POINT)

    def sample(self, world: World) -> Array:
        return through(self._point, np.array(world.pose()))


def logs_pose(terms: Terms) -> bool:
    """Whether a term says anything of the pose log."""
    return any(effects(SENSOR_TERMS, terms, slot) for slot in (Slot.POSE_POINT, Slot.POSE_DELAY))
