"""The arenas in which the trials of a log were driven, and the surfaces on which the rays of its range sensors end."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from configs.schema.arena import ArenaConfig
from physics.arena.rays import RayScene
from physics.arena.surfaces import SURFACES
from sensors.ranging.tof import NOISE_AT_NEAR_MM
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array

CHUNK = 4096
"""Rays in one pass, whose boxes fit into the cache."""


@dataclass(frozen=True)
class ArenaSurface:
    """A floor, a wall or an obstacle."""

    name: str
    material: str
    reflectance: float
    offset_m: float = 0.0
    """Error of a range to it."""
    noise_sd_m: float = 1e-3 * NOISE_AT_NEAR_MM
    """Standard deviation of a near range to it."""


class LogArenas:
    """The arena of each trial. Arenas that differ in a few surfaces share the others."""

    def __init__(self, arenas: Sequence[ArenaConfig]) -> None:
        """
        Args:
            arenas: Arena of each trial.
        """
        distinct: list[ArenaConfig] = []
        for config in arenas:
            if config not in distinct:
                distinct.append(config)
        self._of_trial = [distinct.index(config) for config in arenas]
        built = [Arena.from_config(config) for config in distinct]
        self._scenes = [RayScene(arena) for arena in built]
        self._moves = [any(box.motion is not None for box in arena.boxes) for arena in built]
        several = [_surfaces(arena) for arena in built]
        self.surfaces = tuple(dict.fromkeys(surface for surfaces in several for surface in surfaces))
        self._places = [np.array([self.surfaces.index(surface) for surface in surfaces]) for surfaces in several]

    @cached_property
    def materials(self) -> tuple[str, ...]:
        """Materials of the surfaces, each once."""
        return tuple(dict.fromkeys(surface.material for surface in self.surfaces))

    @cached_property
    def made_of(self) -> Array:
        """(surfaces, materials), 1 where a surface is of a material, else 0."""
        return np.array([[float(each.material == name) for name in self.materials] for each in self.surfaces])

    def hits(
        self, trial: NDArray[np.int64], origins: Array, rays: Array, t_s: Array
    ) -> tuple[Array, NDArray[np.int64], Array]:
        """Return fraction and surface (n, R) and normal (n, R, 3) of what R rays from each of n places hit.

        Args:
            trial: (n,), trial of each place.
            origins: (n, 3), places in W.
            rays: (n, R, 3), rays from their origins to their ends.
            t_s: (n,), time since the start of the session, at which obstacles that move are placed.
        """
        places, count = rays.shape[:2]
        fraction, surface = np.empty((places, count)), np.empty((places, count), dtype=np.int64)
        normal, arena = np.empty_like(rays), np.array(self._of_trial)[trial]
        for number in np.unique(arena).tolist():
            moves = self._moves[number]
            rows = np.flatnonzero(arena == number)
            step = 1 if moves else max(1, CHUNK // count)
            for part in np.split(rows, range(step, len(rows), step)):
                starts = np.repeat(origins[part], count, axis=0)
                ends = starts + rays[part].reshape(-1, 3)
                hits = self._scenes[number].cast(starts, ends, float(t_s[part[0]]) if moves else 0.0)
                fraction[part], normal[part] = hits.fraction.reshape(-1, count), hits.normal.reshape(-1, count, 3)
                # A ray without a hit has a normal of 0 and returns no light, whatever its surface.
                surface[part] = self._places[number][hits.surface].reshape(-1, count)
        return fraction, surface, normal


def _surfaces(arena: Arena) -> list[ArenaSurface]:
    """Return the floor and the surfaces of all boxes of an arena, in the order of `RayHits.surface`."""
    boxes = [(box.name, box.surface, SURFACES[box.surface]) for box in arena.boxes]
    floor = ArenaSurface("floor", "floor", arena.floor_reflectance)
    return [
        floor,
        *(
            ArenaSurface(name, material, s.reflectance, s.offset_m, 1e-3 * s.sd_mm_at_100_mm)
            for name, material, s in boxes
        ),
    ]
