"""A wheel that does not turn about its centre."""

from typing import Annotated, Literal

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Angle, Parameter, Plausible
from symolo.core.arrays import Array

SIDES = np.array(["right", "left"])


class WheelEccentricity(Effect):
    """One wheel turns about a point beside its centre, so that its travel per turn changes once per revolution."""

    slot = Slot.ROLLING
    cause = "a bore off the centre of the rim, a tyre that is mounted unevenly"
    excitation = "drives over many turns of the wheels, whose counts begin at the same angle in each trial"
    setups = (Setup.DRIVE,)

    side: Literal["left", "right"]
    """Wheel that is eccentric."""
    amplitude: Annotated[
        float,
        Parameter("1", null=0.0, start=0.02, low=0.0, high=0.5),
        Plausible(0.0, 0.1, "a bore that is off by a tenth of the radius is visible"),
    ]
    """Travel per turn of this wheel * (1 + amplitude cos(wheel angle + phase)); the other wheel is round."""
    phase_rad: Angle
    """Phase at the wheel angle 0, at which the encoder counts 0."""

    def apply(self, share: Array, angle_rad: Array, turned_rad: Array) -> Array:
        """Return the travel of both wheels as a share of radius * turn, (..., 2), exactly over the turn."""
        swing = self.amplitude * np.cos(angle_rad + self.phase_rad) * np.sinc(turned_rad / (2.0 * np.pi))
        return share * np.where(self.side == SIDES, 1.0 + swing, 1.0)
