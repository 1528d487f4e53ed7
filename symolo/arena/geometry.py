"""The one definition of the arena's geometry: line sensor, collision bodies and meshes are all made from it.

Everything is in the world frame W: x and y on the floor, z up, metres and radians.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from symolo.arena.footprints import Rectangle, obstacle_footprint, wall_footprint
from symolo.arena.forms import ArcForm, ArenaForm, ObstacleForm, StraightForm, WallForm
from symolo.arena.mesh import TriangleMesh, unpacked
from symolo.arena.obstacle_motion import ObstacleMotion
from symolo.core.arrays import Array

Kind = Literal["wall", "obstacle"]


@dataclass(frozen=True)
class Straight:
    """A straight piece of the line, with its ends [m] in W."""

    start: tuple[float, float]
    end: tuple[float, float]

    @cached_property
    def length_m(self) -> float:
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    @cached_property
    def tangent(self) -> tuple[float, float]:
        """Unit vector from start to end."""
        return (self.end[0] - self.start[0]) / self.length_m, (self.end[1] - self.start[1]) / self.length_m

    @property
    def curvature_per_m(self) -> float:
        """0; that of an arc is positive to the left."""
        return 0.0

    def at_min_away_m(self, x_m: float, y_m: float) -> float:
        """Return a lower bound of the distance between a floor point and the piece's centre line."""
        tx, ty = self.tangent
        x, y = x_m - self.start[0], y_m - self.start[1]
        along = tx * x + ty * y
        return max(abs(tx * y - ty * x), -along, along - self.length_m)

    def local(self, points: Array) -> tuple[Array, Array]:
        """Return the arc length along the piece and the offset to its left [m], (N,) each, of points (N, 2)."""
        x, y = points[:, 0] - self.start[0], points[:, 1] - self.start[1]
        tx, ty = self.tangent
        return tx * x + ty * y, tx * y - ty * x

    def at(self, s: Array, offset: Array | float = 0.0) -> Array:
        """Return points (N, 2) at arc lengths `s` (N,) [m], `offset` [m] to the left of the direction of travel."""
        tx, ty = self.tangent
        left = np.broadcast_to(offset, s.shape)
        return np.asarray(self.start) + np.outer(s, (tx, ty)) + np.outer(left, (-ty, tx))


@dataclass(frozen=True)
class Arc:
    """A piece of the line with constant curvature; lengths in m, angles from +x of W."""

    center: tuple[float, float]
    radius_m: float
    start_rad: float
    end_rad: float
    """Counter-clockwise where it is larger than `start_rad`, clockwise where smaller."""

    @property
    def length_m(self) -> float:
        return self.radius_m * abs(self.end_rad - self.start_rad)

    @property
    def turn(self) -> float:
        """+1 counter-clockwise, -1 clockwise."""
        return 1.0 if self.end_rad > self.start_rad else -1.0

    @property
    def curvature_per_m(self) -> float:
        """Positive to the left."""
        return self.turn / self.radius_m

    def at_min_away_m(self, x_m: float, y_m: float) -> float:
        """Return a lower bound of the distance between a floor point and the piece's centre line."""
        return abs(hypot(x_m - self.center[0], y_m - self.center[1]) - self.radius_m)

    def local(self, points: Array) -> tuple[Array, Array]:
        """Return the arc length along the piece and the offset to its left [m], (N,) each, of points (N, 2)."""
        x, y = points[:, 0] - self.center[0], points[:, 1] - self.center[1]
        middle = 0.5 * (self.start_rad + self.end_rad)
        from_middle = (np.arctan2(y, x) - middle + np.pi) % (2 * np.pi) - np.pi
        s = self.radius_m * (self.turn * from_middle) + 0.5 * self.length_m
        return s, self.turn * (self.radius_m - np.hypot(x, y))

    def at(self, s: Array, offset: Array | float = 0.0) -> Array:
        """Return points (N, 2) at arc lengths `s` (N,) [m], `offset` [m] to the left of the direction of travel."""
        angle = self.start_rad + self.turn * s / self.radius_m
        radius = self.radius_m - self.turn * np.broadcast_to(offset, s.shape)
        return np.asarray(self.center) + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@dataclass(frozen=True)
class Chain:
    """Pieces of which each continues the one before: one strip of tape or paint along all of them."""

    pieces: tuple[Straight | Arc, ...]

    @cached_property
    def starts_m(self) -> Array:
        """Arc length at which each piece begins, (N,)."""
        return np.concatenate(([0.0], np.cumsum([piece.length_m for piece in self.pieces[:-1]])))

    @property
    def length_m(self) -> float:
        return float(self.starts_m[-1]) + self.pieces[-1].length_m

    @property
    def curvature_per_m(self) -> float:
        """Mean curvature, positive to the left."""
        return sum(piece.curvature_per_m * piece.length_m for piece in self.pieces) / self.length_m

    def at(self, s: Array, offset: Array | float = 0.0) -> Array:
        """Return points (N, 2) at arc lengths `s` (N,) [m], `offset` [m] to the left of the direction of travel."""
        which = np.maximum(np.searchsorted(self.starts_m, s, side="right") - 1, 0)
        left = np.broadcast_to(offset, s.shape)
        points = np.empty((len(s), 2))
        for number in np.unique(which):
            on = which == number
            points[on] = self.pieces[number].at(s[on] - self.starts_m[number], left[on])
        return points


Strip = Straight | Arc | Chain
"""Tape or paint without a joint."""


@dataclass(frozen=True)
class Line:
    """Tape of constant width along pieces with butt ends."""

    pieces: tuple[Straight | Arc, ...]
    width_m: float
    reflectance: float
    joined: tuple[bool, ...] = ()
    """Whether each piece continues the one before without a joint; none does by default."""

    @cached_property
    def strips(self) -> tuple[Strip, ...]:
        """Return the strips that are laid without a joint: single pieces, and chains of joined ones."""
        joined = self.joined or (False,) * len(self.pieces)
        chains: list[list[Straight | Arc]] = []
        for piece, goes_on in zip(self.pieces, joined, strict=True):
            if goes_on and chains:
                chains[-1].append(piece)
            else:
                chains.append([piece])
        return tuple(chain[0] if len(chain) == 1 else Chain(tuple(chain)) for chain in chains)

    @property
    def length_m(self) -> float:
        return sum(piece.length_m for piece in self.pieces)

    def covers(self, points: Array) -> NDArray[np.bool_]:
        """Return whether each of the floor points (N, 2) lies on the tape, (N,)."""
        covered = np.zeros(len(points), dtype=bool)
        for piece in self.pieces:
            s, offset = piece.local(points)
            covered |= (s >= 0) & (s <= piece.length_m) & (np.abs(offset) <= 0.5 * self.width_m)
        return covered

    def edges(self, spacing_m: float = 0.01) -> list[tuple[Array, Array]]:
        """Return the left and right edge of each piece, (N, 2) each; those of a straight piece have its ends alone."""
        edges = []
        for piece in self.pieces:
            count = 2 if isinstance(piece, Straight) else max(2, int(np.ceil(piece.length_m / spacing_m)) + 1)
            s = np.linspace(0.0, piece.length_m, count)
            edges.append((piece.at(s, 0.5 * self.width_m), piece.at(s, -0.5 * self.width_m)))
        return edges


@dataclass(frozen=True)
class Box:
    """A wall or an obstacle that stands on the floor."""

    name: str
    kind: Kind
    center: tuple[float, float, float]
    size: tuple[float, float, float]
    """Lengths along its own x, y, z [m]."""
    yaw_rad: float
    surface: str
    motion: ObstacleMotion | None = None
    """Motion of the box, whose `center` and `yaw_rad` are then those at t = 0; None where it stands still."""
    mesh: TriangleMesh | None = None
    """Shape of the body, whose bounding box this then is; None for a box."""
    is_solid: bool = True
    """Whether robots touch it and range sensors see it; images always show it."""

    def footprint(self) -> Array:
        """Return the corners (4, 2) [m] in W, counter-clockwise, at t = 0."""
        return np.array(Rectangle(self.center[:2], self.size[:2], self.yaw_rad).corners())

    def poses_at(self, t_s: Array) -> Array:
        """Return the poses (N, 3) of its middle, x [m], y [m], yaw [rad], at times (N,) [s] since the run began."""
        if self.motion is not None:
            return self.motion.poses_at(t_s)
        return np.tile([*self.center[:2], self.yaw_rad], (len(t_s), 1))


@dataclass(frozen=True)
class Arena:
    """Floor, line, walls and obstacles."""

    name: str
    floor_half_extent_m: float
    floor_reflectance: float
    line: Line
    boxes: tuple[Box, ...]

    @classmethod
    def from_config(cls, config: ArenaForm) -> "Arena":
        return cls(
            name=config.name,
            floor_half_extent_m=config.floor.half_extent_m,
            floor_reflectance=config.floor.reflectance,
            line=Line(
                tuple(_piece(piece) for piece in config.line.pieces),
                config.line.width_m,
                config.line.reflectance,
                tuple(piece.joined for piece in config.line.pieces),
            ),
            boxes=tuple(_wall(w) for w in config.walls) + tuple(_obstacle(o) for o in config.obstacles),
        )

    @property
    def moving(self) -> tuple[Box, ...]:
        """The boxes on a timed path, in their order."""
        return tuple(box for box in self.boxes if box.motion is not None)


def _piece(config: StraightForm | ArcForm) -> Straight | Arc:
    if config.kind == "straight":
        return Straight(config.start, config.end)
    return Arc(config.center, config.radius_m, float(np.radians(config.start_deg)), float(np.radians(config.end_deg)))


def _wall(wall: WallForm) -> Box:
    return _box(wall.name, "wall", wall_footprint(wall), wall.height_m, wall.surface)


def _obstacle(obstacle: ObstacleForm) -> Box:
    box = _box(obstacle.name, "obstacle", obstacle_footprint(obstacle), obstacle.size[2], obstacle.surface)
    mesh = unpacked(obstacle.mesh.packed) if obstacle.mesh is not None else None
    return replace(box, motion=ObstacleMotion.from_config(obstacle), mesh=mesh, is_solid=obstacle.solid)


def _box(name: str, kind: Kind, footprint: Rectangle, height_m: float, surface: str) -> Box:
    center, size = (*footprint.center, 0.5 * height_m), (*footprint.size, height_m)
    return Box(name, kind, center, size, footprint.yaw_rad, surface)
