"""What wheels lose by slip: on a patch of the floor, or while they accelerate or brake, as functions for a test.

A wheel on dust, on a wet place or on a cable turns further than it rolls. So does one whose torque comes near what its
tyre can hold. Neither is a number of the robot: the first is there at one place only, the second at some accelerations.
Where such a patch is, how large it is, and whether it takes grip from both wheels or only from the one with the worse
tyre, is not known. Neither is the acceleration from which a wheel slips. Each possibility is a set of functions of its
own: the motion that is lost if a wheel loses its whole travel there. They follow from the counts and the logged places.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np
from numpy.typing import NDArray

from diagnosis.predictors.base import Covariate, CovariateShape
from symolo.core.arrays import Array

ACCELERATION = "acceleration_m_s2"
"""Name of the covariate with the acceleration of the rims of the wheels."""
PATCH, SLIP = "patch", "slip"
"""What the functions are."""
FORWARD, TURN = 0, 2
"""Components of a change of the pose that slip changes; to the side it hardly does."""
LARGEST = 0.99
"""Share of the rows whose acceleration is below the unit of the thresholds."""
THRESHOLDS = (0.1, 0.2, 0.35, 0.5)
"""Accelerations from which a wheel may slip, in that unit."""
FAST = 0.9
"""Share of the changes of the pose whose travel is below the unit of the radii."""
RADII = (0.6, 1.2)
"""Radii of patches, in that unit. A change of the pose does not show where in it motion was lost."""
EDGE = 0.5
"""Half of the width of the edge of a patch, in radii."""
MAX_PATCHES = 100
"""Largest number of places of a patch of one radius; a larger room has fewer, larger ones."""
BOTH, RIGHT, LEFT = (True, True), (True, False), (False, True)


@dataclass(frozen=True)
class CountedMotion:
    """Motion of both wheels by their counts, of all rows, and the changes of the pose to which it adds up."""

    travel_m: Array
    """(n, 2), travel of the right and the left rim since the row before; 0 in the first row of a trial."""
    steps_s: Array
    """(n,), time since the row before."""
    poses: Array
    """(n, 3), place of the robot in the middle of the motion of each row, and logged heading; NaN where not known."""
    starts: NDArray[np.int64]
    """(N,), first row of each trial."""
    windows: tuple[NDArray[np.int64], NDArray[np.int64]]
    """First and last row (m,) of each change of the pose. The motion of the first row is before it."""
    track_m: float
    count_m: float
    """Travel of a count."""

    def changed(self, lost_m: Array, component: int) -> Array:
        """Return a component of the changes of the pose (m, ...) if the rims lose travel (n, 2, ...)."""
        right, left = lost_m[:, 0], lost_m[:, 1]
        lost = 0.5 * (right + left) if component == FORWARD else (right - left) / self.track_m
        total, (first, last) = np.cumsum(lost, axis=0), self.windows
        return total[last] - total[first]


def slip_functions(motion: CountedMotion, component: int) -> tuple[tuple[Array, ...], tuple[Covariate, ...]]:
    """Return the sets of functions of the place, and the covariates of slip that depends on the motion alone.

    Args:
        motion: The motion of both wheels.
        component: Component of the change of the pose; none but FORWARD and TURN has functions.
    """
    if component not in {FORWARD, TURN}:
        return (), ()
    acceleration = _speeding_up(motion)
    first, last = motion.windows
    middle = acceleration[(first + last) // 2].mean(axis=-1)
    functions = tuple(_accelerating(motion, acceleration, component))
    covariate = Covariate(ACCELERATION, middle, CovariateShape.COMPUTED, functions=functions, functions_are=SLIP)
    return tuple(_patches(motion, component)), (covariate,) if functions else ()


def _speeding_up(motion: CountedMotion) -> Array:
    """Return the acceleration (n, 2) of each rim in the direction in which it turns, negative where it brakes."""
    speed_m_s = motion.travel_m / motion.steps_s[:, None]
    rise = np.diff(speed_m_s, axis=0, prepend=speed_m_s[:1]) / motion.steps_s[:, None]
    # The travel of a first row is 0, and so is the speed before: each trial begins at rest.
    rise[motion.starts] = 0.0
    next_rise = np.append(rise[1:], np.zeros_like(rise[:1]), axis=0)
    return np.sign(motion.travel_m) * 0.5 * (rise + next_rise)


def _accelerating(motion: CountedMotion, acceleration_m_s2: Array, component: int) -> Iterator[Array]:
    """Yield what is lost in proportion to the acceleration, and beyond each threshold, apart for either sign."""
    floor = motion.count_m / float(np.median(motion.steps_s)) ** 2
    largest = float(np.quantile(np.abs(acceleration_m_s2), LARGEST))
    if not largest > floor:
        return
    beyond = np.maximum(np.abs(acceleration_m_s2) - floor, 0.0) / largest
    thresholds = np.unique(np.maximum(largest * np.array(THRESHOLDS), floor)).tolist()
    shares = (beyond, *((np.abs(acceleration_m_s2) > threshold).astype(float) for threshold in thresholds))
    signs = np.stack([acceleration_m_s2 > 0.0, acceleration_m_s2 < 0.0], axis=-1)
    for share in shares:
        yield motion.changed((motion.travel_m * share)[..., None] * signs, component)


def _patches(motion: CountedMotion, component: int) -> Iterator[Array]:
    """Yield what is lost on each patch, by the wheels that stand on it."""
    across = 0.5 * motion.track_m * np.stack([np.sin(motion.poses[:, 2]), -np.cos(motion.poses[:, 2])], axis=-1)
    places = np.stack([motion.poses[:, :2] + across, motion.poses[:, :2] - across], axis=1)
    known = np.isfinite(places).all(axis=-1)
    driven_m = np.abs(motion.changed(np.abs(motion.travel_m), FORWARD))
    driven_m = driven_m[driven_m > motion.count_m]
    if not known.any() or not len(driven_m):
        return
    # The distance forward hardly shows which wheel loses it. The turn shows the difference of both wheels alone.
    wheels = (BOTH,) if component == FORWARD else (BOTH, RIGHT, LEFT)
    for radius in RADII:
        radius_m = radius * float(np.quantile(driven_m, FAST))
        # One patch after the other: all of them at once would take gigabytes in a drive of an hour.
        for centre in _centres(places[known], radius_m):
            apart_m = np.hypot(*np.moveaxis(places - centre, -1, 0))
            inside = np.clip((1.0 + EDGE - apart_m / radius_m) / (2.0 * EDGE), 0.0, 1.0)
            lost_m = motion.travel_m * np.where(known, inside, 0.0)
            yield from (motion.changed(lost_m[..., None] * np.array(which)[:, None], component) for which in wheels)


def _centres(places_m: Array, radius_m: float) -> Array:
    """Return the centres (k, 2) of patches, a radius apart, over all places (n, 2); none if they would be too many."""
    low, high = places_m.min(axis=0), places_m.max(axis=0)
    counts = [max(1, round(side_m / radius_m)) + 1 for side_m in (high - low).tolist()]
    if prod(counts) > MAX_PATCHES:
        return np.empty((0, 2))
    return np.array(list(product(*(np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)))))
