"""Worlds whose ray casts have a closed form."""

from dataclasses import dataclass

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from symolo.arena.geometry import Arena, Box, Line, Straight


@dataclass
class Hits:
    fraction: np.ndarray
    surface: np.ndarray
    normal: np.ndarray


@dataclass
class PlaneWorld:
    """An infinite wall across the x axis at `wall_x_m`, and nothing else; the robot stands at `x`, `y`, `yaw`.

    With `axis` 1 the wall is across the y axis.
    """

    wall_x_m: float = 1e9
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    floor: bool = False
    counts: tuple[int, int] = (0, 0)
    time_s: float = 0.0
    axis: int = 0

    def pose(self):
        return self.at

    def encoder_counts(self):
        return self.counts

    def cast(self, origins, ends):
        way = ends - origins
        with np.errstate(divide="ignore"):
            wall = (self.wall_x_m - origins[:, self.axis]) / way[:, self.axis]
            floor = -origins[:, 2] / way[:, 2]
        wall = np.where((wall > 0) & (wall <= 1), wall, np.inf)
        floor = np.where((floor > 0) & (floor <= 1) & self.floor, floor, np.inf)
        fraction = np.minimum(wall, floor)
        surface = np.where(np.isinf(fraction), -1, np.where(floor < wall, 0, 1))
        normal = np.where(
            (surface == 1)[:, None], -np.eye(3)[self.axis], np.where((surface == 0)[:, None], [0, 0, 1.0], 0.0)
        )
        return Hits(np.minimum(fraction, 1.0), surface, normal)


@pytest.fixture
def plane_world():
    return PlaneWorld


@pytest.fixture(scope="session")
def robot():
    return draw_run(load_scenario("symolo"), "CW", 1).robot


@pytest.fixture
def arena_of():
    """An arena with one straight line along x through the origin, and one box of a surface."""

    def build(surface="white_board", width_m=0.015):
        line = Line((Straight((-5.0, 0.0), (5.0, 0.0)),), width_m, reflectance=0.0)
        box = Box("wall", "wall", (0.0, 0.0, 0.075), (0.02, 1.0, 0.15), 0.0, surface)
        return Arena("test", 4.0, 1.0, line, (box,))

    return build
