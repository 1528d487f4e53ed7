"""Closed form of the real scan: rays at a ball in front of a plane board."""

from dataclasses import dataclass

import numpy as np

from diagnosis.validation.range_sensor.stand import HEIGHT_M
from physics.arena.rays import RayHits
from symolo.core.arrays import Array

BALL, BOARD = 1, 2


@dataclass(frozen=True)
class BallScene:
    """A ball and a board behind it, for rays that start in front of both and point towards +x."""

    nearest_m: float
    """Distance from the plane x = 0 to the ball."""
    radius_m: float
    board_m: float
    """Distance from the plane x = 0 to the board."""
    y_m: float = 0.0
    """Lateral coordinate of the centre of the ball."""
    z_m: float = HEIGHT_M
    """Height of the centre of the ball."""

    def cast(self, origins: Array, ends: Array) -> RayHits:
        """Return hits with surface 1 for the ball and 2 for the board; no ray meets the floor."""
        step = ends - origins
        from_centre = origins - (self.nearest_m + self.radius_m, self.y_m, self.z_m)
        # |from_centre + f step| = radius, a quadratic in the fraction f.
        a = np.einsum("ij,ij->i", step, step)
        half_b = np.einsum("ij,ij->i", from_centre, step)
        c = np.einsum("ij,ij->i", from_centre, from_centre) - self.radius_m**2
        under_root = half_b**2 - a * c
        first = (-half_b - np.sqrt(np.maximum(under_root, 0.0))) / a
        on_ball = (under_root > 0.0) & (first > 0.0) & (first <= 1.0)
        at_board = (self.board_m - origins[:, 0]) / step[:, 0]
        on_board = ~on_ball & (at_board > 0.0) & (at_board <= 1.0)
        fraction = np.where(on_ball, first, np.where(on_board, at_board, 1.0))
        outward = (from_centre + fraction[:, None] * step) / self.radius_m
        towards = np.where(on_board[:, None], (-1.0, 0.0, 0.0), 0.0)
        surface = np.where(on_ball, BALL, np.where(on_board, BOARD, -1))
        return RayHits(fraction, surface, np.where(on_ball[:, None], outward, towards))
