"""State of a shaft that friction depends on."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array


@dataclass(frozen=True)
class ShaftMotion:
    """Direction, speed and history of a shaft, on which its friction depends; arrays have the wheels as their last
    axis.
    """

    direction: Array
    """Direction of the motion, at rest of the torque that would start it: -1, 0 or +1."""
    speed_rad_s: Array
    """Speed of the shaft, as at the wheel."""
    time_s: float | Array
    """Time since the motor was first switched on."""
    trend: float | Array
    """Last change of the commanded voltage's size: +1 if it grew, -1 if it fell."""
    x_m: float | Array = 0.0
    """Place of the middle of the axle along x of W; 0 on a bench, and where it is not known."""
    y_m: float | Array = 0.0
    """Place of the middle of the axle along y of W."""


def voltage_trend(command_V: Array) -> Array:
    """Return whether the size of a voltage last grew (+1) or fell (-1), of the same shape (T, ...); 0 V come before.

    A voltage that stays keeps the trend, and one that is not known (NaN) counts as one that stays.
    """
    size = np.abs(command_V)
    number = np.arange(len(size)).reshape(-1, *(1,) * (size.ndim - 1))
    known = np.maximum.accumulate(np.where(np.isfinite(size), number, -1))
    size = np.where(known >= 0, np.take_along_axis(size, np.maximum(known, 0), axis=0), 0.0)
    change = np.diff(size, axis=0, prepend=0.0)
    last = np.maximum.accumulate(np.where(change != 0.0, number, -1))
    return np.where((last >= 0) & (np.take_along_axis(change, np.maximum(last, 0), axis=0) < 0.0), -1.0, 1.0)
