"""A further encoder at a wheel: incremental with or without direction, or absolute."""

from typing import Literal

import numpy as np
from pydantic import Field

from configs.robot_sensors import SensorSettings
from sensors.base import Reading, Sensor, World
from symolo.arena.geometry import Arena
from symolo.dataset.tables.column import Column


class WheelEncoderSettings(SensorSettings):
    """Wheel, resolution and principle of an encoder."""

    period_s: float = Field(default=0.01, gt=0, le=1)
    """Time between two readings of the counter."""
    wheel: Literal["right", "left"] = "right"
    """Wheel that it sits on."""
    counts_per_revolution: int = Field(default=12, ge=1, le=1_000_000)
    """Counts per turn of the wheel, all edges counted."""
    principle: Literal["quadrature", "single", "absolute"] = "quadrature"
    """Principle: `quadrature` counts up and down, `single` counts every edge upwards whatever the direction, and
    `absolute` gives the position within the turn, from 0."""
    dropout_probability: float = Field(default=0.0, ge=0, le=1)
    """Probability that a reading fails, so that the previous one stands."""


class WheelEncoder(Sensor):
    """Counts of an encoder at a wheel."""

    Settings = WheelEncoderSettings
    columns = (Column("counts", "encoder counts", 0, "counts since the start, or the position of an absolute encoder"),)
    settings: WheelEncoderSettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        # The angle at the start is any; an incremental encoder does not show it.
        self._phase = float(rng.random())
        self._before = self._edges(0.0)
        self._counts = 0
        self._last = 0

    def sample(self, world: World) -> Reading:
        """Return the counts, (1,)."""
        config = self.settings
        right_rad, left_rad = world.wheel_angles()
        edges = self._edges(right_rad if config.wheel == "right" else left_rad)
        moved = edges - self._before
        self._before = edges
        self._counts += abs(moved) if config.principle == "single" else moved
        if self.rng.random() >= config.dropout_probability:
            self._last = edges % config.counts_per_revolution if config.principle == "absolute" else self._counts
        return np.array([float(self._last)])

    def _edges(self, angle_rad: float) -> int:
        """Return the number of edges from an arbitrary zero to an angle."""
        turns = angle_rad / (2.0 * np.pi)
        return int(np.floor((turns + self._phase) * self.settings.counts_per_revolution))
