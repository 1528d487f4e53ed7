"""Wheels that are oval: the radius changes twice per turn."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class OvalWheel(Effect):
    slot = Slot.ROLLING
    cause = "tyres that were stored under load, or that were printed oval"
    excitation = "several turns of the wheels, with poses more often than twice a turn"
    setups = (Setup.DRIVE,)

    amplitude: Annotated[float, Parameter("1", null=0.0, start=0.03, low=-0.3, high=0.3)]
    """radius * (1 + amplitude * cos(2 * wheel angle)), at both wheels."""

    def apply(self, share: Array, angle_rad: Array, turned_rad: Array) -> Array:
        """Return the travel as a share of that of a round wheel, with the mean of the ripple over the turn."""
        return share + self.amplitude * np.cos(2.0 * angle_rad) * np.sinc(turned_rad / np.pi)
