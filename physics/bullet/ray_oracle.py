"""PyBullet's ray test on an arena, as an independent check of the closed-form rays of `physics.arena.rays`."""

import numpy as np
import pybullet
from typing_extensions import Self

from physics.arena.rays import RayHits
from physics.bullet.world import add_arena, connect
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array

BATCH = 10_000
"""Rays per call; the engine silently ignores more than 16,384."""


class EngineRays:
    """The arena's bodies in a separate PyBullet client, as a context manager.

    Ranges are accurate to about 3 mm near edges, which the engine rounds, and to 0.1 mm elsewhere.
    """

    def __init__(self, arena: Arena) -> None:
        self._client = connect(1000)
        self._surface_of_body = add_arena(self._client, arena)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        pybullet.disconnect(self._client)

    def cast(self, origins: Array, ends: Array) -> RayHits:
        """Cast rays from `origins` to `ends`, (N, 3) each, in W."""
        rays = []
        for first in range(0, len(origins), BATCH):
            some = slice(first, first + BATCH)
            rays += pybullet.rayTestBatch(origins[some], ends[some], physicsClientId=self._client)
        surface = np.array([self._surface_of_body.get(ray[0], -1) for ray in rays])
        met = surface >= 0
        return RayHits(
            fraction=np.where(met, [ray[2] for ray in rays], 1.0),
            surface=surface,
            normal=np.where(met[:, None], [ray[4] for ray in rays], 0.0),
        )
