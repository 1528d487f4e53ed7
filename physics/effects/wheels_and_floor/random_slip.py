"""Wheels that slip at random, so that the error of odometry grows with the square root of the distance."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class RandomSlip(Effect):
    """Each wheel slips at random, so that the error of odometry grows with the square root of the distance."""

    slot = Slot.SLIP
    cause = "dust, joints and bumps of the floor, tyres that deform"
    excitation = "long drives with known poses"
    setups = (Setup.DRIVE,)

    slip_m_sqrt_m: Annotated[float, Parameter("m/sqrt(m)", null=0.0, start=1e-3, low=0.0, high=0.05)]
    """Standard deviation of the random error of a wheel's travel after 1 m. The variance grows with the distance (Chong
    and Kleeman, "Accurate odometry and error modelling for a mobile robot", ICRA 1997)."""
    length_m: Annotated[float, Parameter("m", null=None, start=0.05, low=0.001, high=1.0, is_known=True)] = 0.05
    """Distance over which the slip of a wheel stays about the same; over much longer ones, it does not matter."""

    def apply(self, share: Array, travel_m: Array, deviates: Array) -> Array:
        """Return a first-order Gauss-Markov process of the distance.

        Its integral over a distance far beyond `length_m` has the variance 2 sd^2 length_m per metre.
        """
        remaining = np.exp(-travel_m / self.length_m)
        sd = self.slip_m_sqrt_m / np.sqrt(2.0 * self.length_m)
        return remaining * share + sd * np.sqrt(1.0 - remaining**2) * deviates
