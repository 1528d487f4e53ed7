"""Errors of a room and of its range sensors which no effect of the list describes.

A wall that stands elsewhere, or is not parallel to the one across, changes every range to it, by every sensor. Effects
of a single sensor imitate a part of that. So each wall may be shifted or turned, as a rival of the names. The place
that a beam hits is a covariate: what stands in front of a wall, or a wall that is bent, shows along it. Sensors may
also mix each reading with those before.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from diagnosis.measured.case_files.nominal import KnownRoom
from diagnosis.measured.room_distances import WALLS, RoomRanges
from diagnosis.predictors.base import InputResponse
from symolo.core.arrays import Array

WALL_PLACE = "wall_place_m"
"""Name of the covariate with the place that a beam hits, along the walls from the corner at the origin, in the sense of
the headings."""
MEMORIES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Shares of the reading before that are tried."""


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


def memory_errors(distance_m: Array, trial: NDArray[np.int64]) -> Iterator[tuple[str, Array]]:
    """Yield the changes of the readings (n, S) by each share of the reading before that they may keep."""
    begins = np.flatnonzero(np.diff(trial, prepend=-1))
    for share in MEMORIES:
        # The first reading of a trial has none before it.
        parts = [
            lfilter([1.0 - share], [1.0, -share], part, axis=0, zi=share * part[:1])[0]
            for part in np.split(distance_m, begins[1:])
        ]
        yield "memory of the readings before", np.concatenate(parts) - distance_m


def room_errors(
    room: KnownRoom, seen: RoomRanges, distance_m: Array, trial: NDArray[np.int64]
) -> tuple[tuple[InputResponse, ...], ...]:
    """Return the responses of each of the S sensors to these errors.

    Args:
        room: The room.
        seen: What the nominal robot sees.
        distance_m: (n, S), its readings.
        trial: (n,), trial of each row.
    """
    walls = [(WALL_PLACE, what, change, 0) for what, change in wall_errors(room, seen)]
    memories = [("distance_step_m", what, change, 1) for what, change in memory_errors(distance_m, trial)]
    return tuple(
        tuple(InputResponse(name, what, change[:, k], chosen) for name, what, change, chosen in walls + memories)
        for k in range(distance_m.shape[-1])
    )
