"""Wheel encoders as the controller reads them: integer counts, right and left."""

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import Encoder, RobotConfig
from sensors.base import Sampling, Sensor, World
from symolo.arena.geometry import Arena
from symolo.dataset.tables.side_tables import COUNTS


class WheelEncoders(Sensor):
    """Counts (2,), right and left, since the start of the run."""

    name = "encoders"
    Settings = Encoder
    series = (COUNTS,)

    def __init__(self, config: Encoder, physics_hz: int, rng: np.random.Generator) -> None:
        self.sampling = Sampling.from_seconds(config.period_s, config.delay_s, physics_hz)
        self._dropout_probability = config.dropout_probability
        self._rng = rng
        self._last = np.zeros(2, dtype=np.int64)

    @classmethod
    def on_robot(cls, robot: RobotConfig, arena: Arena, physics_hz: int, rng: np.random.Generator) -> "WheelEncoders":
        del arena
        return cls(robot.encoder, physics_hz, rng)

    def sample(self, world: World) -> NDArray[np.int64]:
        fresh = np.array(world.encoder_counts(), dtype=np.int64)
        lost = self._rng.random(2) < self._dropout_probability
        self._last = np.where(lost, self._last, fresh)
        return self._last
