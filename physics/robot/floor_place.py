"""Where and when a robot drives, for effects that depend on the place or change with time."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array

SIDES = np.array(["right", "left"])
"""Sides in the order of every array of wheels."""


@dataclass(frozen=True)
class FloorPlace:
    """All broadcast with arrays of wheels; their last axis has length 1."""

    x_m: float | Array
    """Place of the middle of the axle along x of W."""
    y_m: float | Array
    """Place of the middle of the axle along y of W."""
    time_s: float | Array
    """Time since power-on."""


def at_wheel(side: str, wheels: Array) -> Array:
    """Return 1 for the wheel of one side and 0 for the other, to be broadcast with an array of wheels (..., 2).

    A single motor on a bench (..., 1) may be either, so it gets 1.
    """
    return np.ones(1) if np.shape(wheels)[-1:] == (1,) else np.where(side == SIDES, 1.0, 0.0)
