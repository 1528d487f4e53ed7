"""Friction of the floor that depends on the place, and how the speeds of the wheels respond to it.

A joint between tiles, a cable or a strip of carpet brakes a wheel for a row or two, wherever the robot crosses it. So
the place must be divided more finely than a room, and what the floor does in a row lasts in the speed for as long as
the motor needs. The same floor is under both wheels: under each where it stands, or, if a caster or the body is braked,
at the same place for both. Strips lie along the axes of the map, patches in a grid.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import SharedFunctions
from diagnosis.predictors.wheels.count_noise import CountNoise
from symolo.core.arrays import Array

FRICTION = "friction"
"""Beginning of what such a dependence is."""
UNDER_MIDDLE = ", under the middle of the robot"
"""End of what it is if it acts on both wheels at the same place."""
POINTS = 4
"""Points of the path of a row at which the floor counts."""
FAST = 0.9
"""Share of the rows that travel less than the unit of the cells."""
STRIPS, PATCHES = (1.0, 1.5, 2.0, 3.0, 4.0, 8.0), (4.0, 8.0)
"""Widths of strips and sides of patches, in travels of such a row. Rows do not show what is finer."""
MAX_CELLS = 160
"""Largest number of strips or patches; so many need many rows."""
LEAST_TRAVEL_M = 1e-6
"""Travel of a row below which the robot stands still."""


@dataclass(frozen=True, eq=False)
class _Axis:
    """Linear B-splines along one coordinate of the path, with the same knots for both wheels."""

    places_m: Array
    """(n, POINTS), NaN where the place is not known."""
    knots_m: Array
    """(k,), in rising order."""

    def functions(self) -> Array:
        """Return the splines at each point of the path, (n, POINTS, k)."""
        known = np.isfinite(self.places_m)
        at_m = np.where(known, self.places_m, self.knots_m[0])
        return np.stack([np.interp(at_m, self.knots_m, row) * known for row in np.eye(len(self.knots_m))], axis=-1)


def floor_loads(
    poses: Array, track_m: float, signs: Sequence[Array], noises: Sequence[CountNoise], goes_on: Mask
) -> Iterator[tuple[SharedFunctions, ...]]:
    """Yield each possible dependence of the friction on the place, for the left and the right wheel.

    Args:
        poses: (n, 3), logged x [m], y [m], yaw [rad] of each row; NaN where it is not known.
        track_m: Distance between the wheels.
        signs: (n,) for each wheel, sign of its motion.
        noises: Noise of each wheel's speed, with its response to a torque.
        goes_on: (n,), rows that have a next one in their trial.
    """
    middle = poses[:, :2]
    to_left = 0.5 * track_m * np.stack([-np.sin(poses[:, 2]), np.cos(poses[:, 2])], axis=-1)
    travel_m = np.hypot(*np.diff(middle, axis=0).T)[goes_on[:-1]]
    travel_m = travel_m[travel_m > LEAST_TRAVEL_M]
    if not len(travel_m):
        return
    cell_m = float(np.quantile(travel_m, FAST))
    for where, offsets in (("", (to_left, -to_left)), (UNDER_MIDDLE, 2 * (np.zeros_like(middle),))):
        paths = [_path(middle + offset, goes_on) for offset in offsets]
        if not np.isfinite(paths).any():  # Without a heading, nobody knows where the wheels stand.
            continue
        strips = [(f"friction that depends on {name}", width, (k,)) for width in STRIPS for k, name in enumerate("xy")]
        for what, width, coordinates in (*strips, *(("friction in patches", side, (0, 1)) for side in PATCHES)):
            knots = [_knots([path[..., k] for path in paths], width * cell_m) for k in coordinates]
            if np.prod([len(each) for each in knots]) > MAX_CELLS:
                continue
            by_wheel = [
                [_Axis(path[..., k], each) for k, each in zip(coordinates, knots, strict=True)] for path in paths
            ]
            yield tuple(
                SharedFunctions("position", what + where, partial(_responses, axes, sign, noise), path.mean(axis=1))
                for axes, sign, noise, path in zip(by_wheel, signs, noises, paths, strict=True)
            )


def _path(places: Array, goes_on: Mask) -> Array:
    """Return points (n, POINTS, 2) on the straight path from each row to the next, NaN where there is none."""
    step = np.where(goes_on[:, None], np.roll(places, -1, axis=0) - places, np.nan)
    share = (np.arange(POINTS) + 0.5) / POINTS
    return np.asarray(places[:, None] + share[:, None] * step[:, None])


def _knots(places_m: Sequence[Array], width_m: float) -> Array:
    """Return evenly spaced knots of about a width over all places."""
    low, high = (float(limit([limit(each) for each in places_m])) for limit in (np.nanmin, np.nanmax))
    return np.linspace(low, high + 1e-9, max(2, round((high - low) / width_m) + 1))


def _responses(axes: Sequence[_Axis], sign: Array, noise: CountNoise) -> Array:
    """Return the changes (n, k) of the speeds of a wheel by friction in each cell."""
    functions = axes[0].functions()
    if len(axes) > 1:
        functions = (functions[..., :, None] * axes[1].functions()[..., None, :]).reshape(*functions.shape[:2], -1)
    return noise.response(-sign[:, None] * functions.mean(axis=1))
