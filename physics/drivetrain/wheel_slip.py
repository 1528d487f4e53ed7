"""The random slip of both wheels along their way."""

import numpy as np

from configs.effects.base import Slot
from physics.robot.model import RobotModel, applied
from symolo.core.arrays import Array


class WheelSlip:
    """Share by which the travels of wheels differ from rolling, step by step."""

    def __init__(self, model: RobotModel, rng: np.random.Generator | None) -> None:
        """Begin at rest; without random numbers, no wheel slips."""
        self._functions = () if rng is None else model.functions(Slot.SLIP)
        self._rng = rng
        self._share: Array = np.zeros(2)
        self._since_m: Array = np.full(2, np.inf)

    def __bool__(self) -> bool:
        """Return whether the robot has such an effect."""
        return bool(self._functions)

    def travelled(self, rolled_m: Array) -> Array:
        """Return the travels over the floor in one step, relative to those (..., 2) [m] of rolling wheels."""
        if self._rng is None or not self._functions:
            return np.ones_like(rolled_m)
        deviates = self._rng.standard_normal(rolled_m.shape)
        self._share = applied(self._functions, self._share, self._since_m, deviates)
        self._since_m = np.abs(rolled_m)
        return 1.0 + self._share
