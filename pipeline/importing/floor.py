"""The floor on which an imported trajectory lies if no arena is named."""

import math

import numpy as np

from configs.schema.arena import ArenaConfig, Floor, LineConfig
from symolo.core.arrays import Array
from symolo.core.errors import InputError

EMPTY_FLOOR = "floor"
MARGIN_M = 1.0
"""Distance of the path from the end of the floor, so that a camera sees some of it."""
MIN_HALF_EXTENT_M, MAX_HALF_EXTENT_M = 2.0, 50.0


def fitting_floor(place: Array, where: str) -> ArenaConfig:
    """Return an empty floor around the origin of W, on which all places (N, 2) [m] lie.

    Raises:
        InputError: The path is too far away from the origin.
    """
    reach_m = float(np.abs(place).max())
    half_m = max(MIN_HALF_EXTENT_M, math.ceil(reach_m + MARGIN_M))
    if half_m > MAX_HALF_EXTENT_M:
        raise InputError(
            f"the path is up to {reach_m:.4g} m away from the origin",
            where=where,
            allowed=f"{MAX_HALF_EXTENT_M - MARGIN_M:g} m",
            cure="name the unit of its places in a mapping file, or import a smaller part of the path",
        )
    floor = Floor(half_extent_m=half_m)
    return ArenaConfig(
        name=EMPTY_FLOOR, description="An empty floor that fits the path", floor=floor, line=LineConfig()
    )


def middle_of(places: list[Array]) -> tuple[float, float]:
    """Return the middle of the rectangle around places (N, 2) of several runs, to centimetres."""
    whole = np.concatenate(places)
    x_m, y_m = (0.5 * (whole.min(axis=0) + whole.max(axis=0))).round(2).tolist()
    return x_m, y_m
