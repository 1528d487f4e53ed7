"""The jump by which a heading is wrapped, which a wrong unit changes."""

import math

import numpy as np

from symolo.core.arrays import Array

TURN_RAD = 2.0 * math.pi
BEYOND_RAD = TURN_RAD + 0.5
"""Largest value of a wrapped heading in its own unit of radians, with a margin."""
MIN_WRAP_DEG = 300.0
"""Jump of a heading from one row to the next from which it is a wrapped turn in degrees."""


def whole_turn(angle: Array) -> float:
    """Return the jump by which an angle (N,) is wrapped: that of a whole turn, in whichever unit its values are.

    An angle that was taken for radians and is in degrees jumps by 360; one that was taken for degrees and is in radians
    jumps by a whole turn times pi / 180. Unwrapped by any other jump, it would no longer show its unit.
    """
    if not len(angle):
        return TURN_RAD
    largest, steps = float(np.abs(angle).max()), np.abs(np.diff(angle))
    if largest > BEYOND_RAD and (
        steps.max(initial=0.0) > MIN_WRAP_DEG or (len(steps) > 0 and np.quantile(steps, 0.9) > math.pi)
    ):
        return 360.0
    small = math.radians(TURN_RAD)
    is_small = largest <= math.radians(BEYOND_RAD) and np.abs(steps - small).min(initial=small) < 0.1 * small
    return small if is_small else TURN_RAD
