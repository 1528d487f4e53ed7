"""Keeps the rays that a sensor casts."""

from dataclasses import dataclass, field

import numpy as np

from diagnosis.validation.range_sensor.stand import Caster
from sensors.base import Hits
from symolo.core.arrays import Array


@dataclass
class Recorder:
    """Passes every cast on to another caster and keeps the last one."""

    caster: Caster
    origins: Array = field(default_factory=lambda: np.zeros((0, 3)))
    ends: Array = field(default_factory=lambda: np.zeros((0, 3)))
    fraction: Array = field(default_factory=lambda: np.zeros(0))

    def cast(self, origins: Array, ends: Array) -> Hits:
        hits = self.caster.cast(origins, ends)
        self.origins, self.ends, self.fraction = origins, ends, hits.fraction
        return hits

    def points(self) -> Array:
        """Where the rays of the last cast ended, (N, 3) in W."""
        return self.origins + self.fraction[:, None] * (self.ends - self.origins)
