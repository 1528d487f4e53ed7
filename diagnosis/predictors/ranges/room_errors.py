"""Errors of a room which no effect of the list describes.

A wall that stands elsewhere, or is not parallel to the one across, changes every range to it, by every sensor. Effects
of a single sensor imitate a part of that. So each wall may be shifted or turned, as a rival of the names. The place
that a beam hits is a covariate: what stands in front of a wall, or a wall that is bent, shows along it.
"""

from collections.abc import Iterator

import numpy as np

from diagnosis.measured.case_files.nominal import KnownRoom
from diagnosis.measured.room_distances import WALLS, RoomRanges
from diagnosis.predictors.base import InputResponse
from symolo.core.arrays import Array

WALL_PLACE = "wall_place_m"
"""Name of the covariate with the place that a beam hits, along the walls from the corner at the origin, in the sense of
the headings."""


def corners_m(room: KnownRoom) -> tuple[float, ...]:
    """Return the places of the corners along the walls, from the origin and back to it."""
    x_m, y_m = room.room_x_m, room.room_y_m
    return (0.0, x_m, x_m + y_m, 2.0 * x_m + y_m, 2.0 * (x_m + y_m))


def wall_place_m(room: KnownRoom, seen: RoomRanges) -> Array:
    """Return the places along the walls that the axes hit, (..., n, S)."""
    corners = corners_m(room)
    # In the order of WALLS; the walls at x = 0 and y = room_y_m are passed backwards.
    by_wall = (corners[4] - seen.hit_y_m, corners[1] + seen.hit_y_m, seen.hit_x_m, corners[3] - seen.hit_x_m)
    return np.choose(seen.wall, by_wall)


def slant(seen: RoomRanges) -> Array:
    """Return by how much a range grows if its wall moves away, (..., n, S)."""
    return 1.0 / np.cos(seen.incidence_rad)


def wall_errors(room: KnownRoom, seen: RoomRanges) -> Iterator[tuple[str, Array]]:
    """Yield what each error of a wall is, and the change of the ranges (n, S) by one metre at an end of the wall."""
    for number, wall in enumerate(WALLS):
        hit = np.where(seen.wall == number, slant(seen), 0.0)
        is_x = number < 2
        place_m, length_m = (seen.hit_y_m, room.room_y_m) if is_x else (seen.hit_x_m, room.room_x_m)
        yield f"shift of the wall {wall}", hit
        yield f"turn of the wall {wall}", hit * (2.0 * place_m / length_m - 1.0)


def room_errors(room: KnownRoom, seen: RoomRanges) -> tuple[tuple[InputResponse, ...], ...]:
    """Return the responses of each of the S sensors to the errors of the walls, for what they see (n, S)."""
    errors = list(wall_errors(room, seen))
    sensors = range(seen.wall.shape[-1])
    return tuple(tuple(InputResponse(WALL_PLACE, what, change[:, k]) for what, change in errors) for k in sensors)
