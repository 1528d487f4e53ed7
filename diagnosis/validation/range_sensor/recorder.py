"""A ray caster that remembers the rays which a sensor casts."""

from dataclasses import dataclass, field

import numpy as np

from diagnosis.validation.still_world import RayCaster
from sensors.base import Hits
from symolo.core.arrays import Array


@dataclass
class RayRecorder:
    """Passes every cast on to another caster and remembers the last one."""

    caster: RayCaster
    origins: Array = field(default_factory=lambda: np.zeros((0, 3)))
    ends: Array = field(default_factory=lambda: np.zeros((0, 3)))
    fraction: Array = field(default_factory=lambda: np.zeros(0))

    def cast(self, origins: Array, ends: Array) -> Hits:
        hits = self.caster.cast(origins, ends)
        self.origins, self.ends, self.fraction = origins, ends, hits.fraction
        return hits

    def points(self) -> Array:
        """Return where the rays of the last cast ended, (N, 3) in W."""
        return self.origins + self.fraction[:, None] * (self.ends - self.origins)
