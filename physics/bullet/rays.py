"""Ray casts against floor, walls and obstacles, in an engine of their own: the robot is not in it and cannot be hit."""

from dataclasses import dataclass

import numpy as np
import pybullet
from numpy.typing import NDArray

from physics.arena import Arena
from physics.bullet.world import add_arena, connect

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hits:
    """The first thing each ray meets."""

    fraction: Array
    """(N,), of the way from origin to end; 1 where nothing was met."""
    surface: NDArray[np.int64]
    """(N,), -1 nothing, 0 the floor, 1 + i for box i of the arena."""
    normal: Array
    """(N, 3), unit normal of what was met, in W; zero where nothing was."""


class RayScene:
    def __init__(self, arena: Arena) -> None:
        self._client = connect()
        surface_of_body = add_arena(self._client, arena)
        # One place more than there are bodies: PyBullet's -1 for "nothing" indexes the last.
        self._surface_of_body = np.full(max(surface_of_body) + 2, -1, dtype=np.int64)
        self._surface_of_body[list(surface_of_body)] = list(surface_of_body.values())

    def cast(self, origins: Array, ends: Array) -> Hits:
        """Cast rays from `origins` to `ends`, (N, 3) each, in W."""
        rays = pybullet.rayTestBatch(origins, ends, 1, physicsClientId=self._client)
        return Hits(
            fraction=np.array([ray[2] for ray in rays]),
            surface=self._surface_of_body[[ray[0] for ray in rays]],
            normal=np.array([ray[4] for ray in rays]),
        )

    def close(self) -> None:
        pybullet.disconnect(self._client)
