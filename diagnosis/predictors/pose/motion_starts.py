"""What a robot does just after it starts to drive or to turn, as functions of how far it has come since then.

A caster that stands across must swing round first, a twisted tyre springs back, play in a joint is taken up. That turns
the robot while it drives, as wheels of different size would do, but only over the first centimetres. Which starts have
such a consequence is not known: all of them, after a stop or a turn on the spot, too, or those against the motion
before. Neither is known how slow a motion counts as none. Each possibility is a set of functions of its own: the motion
within some distances of the start, with its sign or without. They follow from the counts alone.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape
from diagnosis.predictors.pose.reversals import BodyRate
from symolo.core.arrays import Array

SLOW = (0.05, 0.2)
"""Rates up to which the robot counts as not moving, as shares of a rate that is exceeded in one row of a hundred."""
LARGEST = 0.99
DISTANCES = (1.0, 2.0, 4.0, 8.0)
"""Distances from a start, in motions of a row at that rate."""
NEVER = -1
"""Row of the start if there was none yet."""


def start_covariates(
    rates: tuple[BodyRate, BodyRate],
    steps_s: Array,
    trials: Sequence[int],
    windows: tuple[NDArray[np.int64], NDArray[np.int64]],
) -> tuple[Covariate, ...]:
    """Return the distance and the turn since the last start, with the motion of each window near starts.

    Args:
        rates: Rates of turning and of driving.
        steps_s: (n,), time since the row before.
        trials: Number of rows of each trial.
        windows: First and last row (m,) of each window. The motion of the first row is before the window.
    """
    turn, travel = rates
    row_s = float(np.median(steps_s))
    return (
        _since_start("distance_since_start_m", travel.values * steps_s, travel.floor * row_s, trials, windows),
        _since_start("turn_since_start_rad", turn.values * steps_s, turn.floor * row_s, trials, windows),
    )


def _since_start(
    name: str, motion: Array, floor: float, trials: Sequence[int], windows: tuple[NDArray[np.int64], NDArray[np.int64]]
) -> Covariate:
    """Return a covariate by the signed motions (n,) of the rows, and the motion that is rounding or noise."""
    first, last = windows
    begins = np.cumsum([0, *trials[:-1]])
    motion[begins] = 0.0
    largest = float(np.quantile(np.abs(motion), LARGEST))
    functions = []
    for slow in np.unique(np.maximum(largest * np.array(SLOW), floor)).tolist():
        for since in _since(motion, slow, begins):
            near = np.stack([_share_within(since, motion, multiple * largest) for multiple in DISTANCES], axis=-1)
            for size in (motion, np.abs(motion)):
                total = np.cumsum(near * size[:, None], axis=0)
                functions.append(total[last] - total[first])
    any_start = next(_since(motion, floor, begins))[(first + last) // 2]
    return Covariate(name, any_start, CovariateShape.COMPUTED, functions=tuple(functions))


def _since(motion: Array, slow: float, begins: NDArray[np.int64]) -> Iterator[Array]:
    """Yield how far (n,) the robot had come before each row since any start, and since one against the motion before.

    It is infinite before the first start of a trial.
    """
    row = np.arange(len(motion))
    moving = np.abs(motion) > slow
    sign = np.where(moving, np.sign(motion), 0.0)
    before = np.append(0.0, sign[:-1])
    yield _distance_since((sign != before) | ~moving, motion, begins)
    trial_begin = begins[np.searchsorted(begins, row, side="right") - 1]
    last_moving = np.maximum.accumulate(np.where(moving, row, NEVER))
    previous = np.append(NEVER, last_moving[:-1])
    against = moving & (previous >= trial_begin) & (sign != sign[np.maximum(previous, 0)])
    yield _distance_since(against, motion, begins)


def _distance_since(starts: Mask, motion: Array, begins: NDArray[np.int64]) -> Array:
    """Return how far (n,) the robot had come before each row since the last of some rows in which it started."""
    row = np.arange(len(motion))
    trial_begin = begins[np.searchsorted(begins, row, side="right") - 1]
    start = np.maximum.accumulate(np.where(starts, row, NEVER))
    come = np.append(0.0, np.cumsum(np.abs(motion)))
    return np.where(start >= trial_begin, come[row] - come[np.maximum(start, 0)], np.inf)


def _share_within(since: Array, motion: Array, distance: float) -> Array:
    """Return the share (n,) of each row's motion that is within a distance of the start."""
    size = np.abs(motion)
    share = np.divide(distance - since, size, out=np.zeros(len(size)), where=size > 0.0)
    return np.clip(share, 0.0, 1.0)
