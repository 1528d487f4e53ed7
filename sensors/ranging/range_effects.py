"""Effects of a robot on a range reading, its noise and its limit, for simulated readings and for expected ones."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from physics.robot.model import applied
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array

_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(15)
NODES, WEIGHTS = _NODES.tolist(), (_WEIGHTS / _WEIGHTS.sum()).tolist()
"""Standard normal deviates and their weights, for means over the noise."""

Functions = tuple[Callable[..., Any], ...]


@dataclass(frozen=True)
class RangeEffects:
    """Functions in the order in which they act; parameters of many robots may be stacked and are then broadcast."""

    reading: Functions
    noise: Functions
    limit: Functions

    @classmethod
    def from_effects(cls, effects: RobotEffects) -> "RangeEffects":
        slots = (Slot.RANGE, Slot.RANGE_NOISE, Slot.RANGE_LIMIT)
        return cls(*(effects.functions(slot) for slot in slots))

    @property
    def need_view(self) -> bool:
        """Whether any of the functions needs a `RangeView`."""
        return bool(self.reading or self.noise)

    def seen(self, reading_m: Array, sd_m: Array, view: RangeView) -> tuple[Array, Array]:
        """Return the reading without noise [m] and the standard deviation of its noise [m]."""
        return applied(self.reading, reading_m, view), applied(self.noise, sd_m, view)

    def limited(self, reading_m: Array) -> Array:
        """Return the reading [m], which is rounded and includes its noise, after the limits."""
        return applied(self.limit, reading_m)

    def expected(self, reading_m: Array, sd_m: Array, view: RangeView, resolution_m: float) -> tuple[Array, Array]:
        """Return mean and standard deviation [m] of readings that are rounded to a resolution.

        Rounding adds the variance resolution^2 / 12 of a uniform error. A limit is not linear, so the mean after it is
        an integral over the normal noise, computed by Gauss-Hermite quadrature. The standard deviation is
        that before the limit, because in some devices the noise is added after the limit.
        """
        mean, sd = self.seen(reading_m, sd_m, view)
        if self.limit:
            drawn = (self.limited(mean + node * sd) for node in NODES)
            mean = sum((weight * value for weight, value in zip(WEIGHTS, drawn, strict=True)), np.zeros(()))
        return mean, np.sqrt(sd**2 + resolution_m**2 / 12.0)
