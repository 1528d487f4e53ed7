"""A floor that is not level, on which the robot creeps downhill."""

from typing import Annotated

import numpy as np
from pydantic import Field

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Angle, Parameter, Plausible
from symolo.core.arrays import Array
from symolo.core.left_out import equals


class FloorSlope(Effect):
    """The robot creeps downhill while its wheels roll, in proportion to its travel and always in the same direction in
    W.
    """

    slot = Slot.CREEP
    cause = "a slope, or the nap of a carpet"
    excitation = "drives in many directions: the creep stays in its direction when the robot turns"
    setups = (Setup.DRIVE,)

    gradient: Annotated[
        float,
        Parameter("1", null=0.0, start=0.02, low=0.0, high=0.5),
        Plausible(0.0, 0.2, "tyres that creep by a fifth of their travel slide"),
    ]
    """Creep over the floor per travel of the robot."""
    direction_rad: Angle
    """Direction of the creep in W, counter-clockwise from +x."""
    on_the_spot: Annotated[
        float,
        Parameter("1", null=None, start=0.5, low=0.0, high=1.0, is_known=True),
        Field(exclude_if=equals(1.0)),  # a specification has the bytes that it had before this number existed
    ] = 1.0
    """Creep in a turn on the spot, relative to that on a straight line with as much rolling of the wheels. Tyres creep
    as they roll, so that it is 1. It is 0 if the robot creeps only while the middle of its axle moves."""

    def apply(self, creep_m: Array, rolled_m: Array, middle_m: Array) -> Array:
        """Return the creep x, y [m] in W, (..., 2)."""
        ways = [np.atleast_1d(component(self.direction_rad)) for component in (np.cos, np.sin)]
        travel_m = middle_m + self.on_the_spot * (rolled_m - middle_m)
        return creep_m + self.gradient * travel_m * np.concatenate(ways, axis=-1)
