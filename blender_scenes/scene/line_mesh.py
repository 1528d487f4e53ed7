"""Meshes of the line, with the same edges that the line sensor reads.

u runs along the line, v from the right edge to the left one [m]. Each piece lies 2 um above the one before, so that
the later one covers the earlier one where they cross, also within a strip of joined pieces.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from blender_scenes.scene.description import Mesh, Point2
from symolo.arena.geometry import Chain, Line, Straight, Strip
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

_ABOVE_THE_LAST_M = 2e-6
_LIFTED_BORDER_M = 0.003
"""Width of the strip of tape that lifts off the floor with its edge."""
_LIFTS_PER_M = 1.5
_RIPPLES_M = ((0.014, 0.5), (0.006, 0.4), (0.0025, 0.3))
"""Wavelengths and shares of the ripples of a painted edge: from the hand, the masking tape and the floor's pores."""
_RIPPLES_END_M = 0.006


def tapes(
    line: Line, surfaces: Sequence[str], *, thickness_m: float, gap_m: float, lift_m: float, seed: int
) -> list[Mesh]:
    """Return a mesh for each strip, `thickness_m` above the floor, shorter by half of `gap_m` at both ends.

    In some places a corner or an edge is up to `lift_m` above the floor; seen from above it is in its place. u is 0
    where the tape begins.
    """
    meshes, half = [], 0.5 * line.width_m
    border = min(_LIFTED_BORDER_M, 0.5 * half)
    columns = np.array([-half, border - half, half - border, half])
    for number, (strip, above_m) in enumerate(_levels(line)):
        begin = 0.5 * (strip.length_m - taped_length_m(strip, gap_m))
        ends = begin, strip.length_m - begin
        lifts = _lifts(ends, lift_m, stream(seed, "lifted tape", number))
        along = _along(strip, ends, lifts)
        lifted = np.zeros((len(along), 4))
        for lift in lifts:
            lifted[:, lift.column] = np.maximum(lifted[:, lift.column], lift.at(along))
        z = thickness_m + above_m(along)[:, None] + lifted
        across = np.broadcast_to(columns, z.shape)
        meshes.append(_mesh(f"tape_{number}", strip, (along, across, z), (-begin, half), surfaces[number]))
    return meshes


def taped_length_m(strip: Strip, gap_m: float) -> float:
    """Return the length of tape on a strip, with a gap of half of `gap_m` at each end; at least half the strip."""
    return max(strip.length_m - gap_m, 0.5 * strip.length_m)


def paint(line: Line, surface: str, *, thickness_m: float, bleeding_m: float, seed: int) -> list[Mesh]:
    """Return a mesh for each strip, without joints: u continues from one to the next.

    Both edges deviate by up to `bleeding_m` from the line's edge, more outwards than inwards; the mean deviation is 0,
    and so is that at the ends of a strip.
    """
    meshes, half, done = [], 0.5 * line.width_m, 0.0
    for number, (strip, above_m) in enumerate(_levels(line)):
        along = np.linspace(0.0, strip.length_m, max(2, int(np.ceil(strip.length_m / 0.001)) + 1))
        out = [_wander(along, bleeding_m, stream(seed, "bleeding paint", number, side)) for side in ("right", "left")]
        across = np.column_stack([-half - out[0], half + out[1]])
        z = np.broadcast_to(thickness_m + above_m(along)[:, None], across.shape)
        meshes.append(_mesh(f"paint_{number}", strip, (along, across, z), (done, half), surface))
        done += strip.length_m
    return meshes


def _levels(line: Line) -> Iterator[tuple[Strip, Callable[[Array], Array]]]:
    """Yield each strip, and the function from arc lengths (N,) on it to their heights (N,) above the first piece."""
    first = 0
    for strip in line.strips:
        starts = strip.starts_m if isinstance(strip, Chain) else np.zeros(1)
        yield strip, partial(_level, first, starts)
        first += len(starts)


def _level(first: int, starts_m: Array, along: Array) -> Array:
    number = np.maximum(np.searchsorted(starts_m, along, side="right") - 1, 0)
    return _ABOVE_THE_LAST_M * (first + number)


@dataclass(frozen=True)
class _Lift:
    middle_m: float
    half_length_m: float
    height_m: float
    column: int

    def at(self, along: Array) -> Array:
        away = np.minimum(np.abs(along - self.middle_m) / self.half_length_m, 1.0)
        return self.height_m * np.cos(0.5 * np.pi * away) ** 2


def _lifts(ends: tuple[float, float], lift_m: float, rng: np.random.Generator) -> list[_Lift]:
    """Draw the lifted places: about every second corner, and edges at random."""
    if lift_m == 0:
        return []
    lifts = []
    for end in ends:
        for column in (0, 3):
            share, length, high = rng.uniform(0.0, 1.0), rng.uniform(0.006, 0.02), rng.uniform(0.4, 1.0)
            if share < 0.5:
                lifts.append(_Lift(end, length, high * lift_m, column))
    for _ in range(rng.poisson(_LIFTS_PER_M * (ends[1] - ends[0]))):
        middle, length, high = rng.uniform(*ends), rng.uniform(0.008, 0.025), rng.uniform(0.3, 0.8)
        lifts.append(_Lift(middle, length, high * lift_m, int(rng.choice((0, 3)))))
    return lifts


def _along(strip: Strip, ends: tuple[float, float], lifts: Sequence[_Lift]) -> Array:
    """Return arc lengths between the ends: every 4 mm on a bend, every 2 mm where the tape is lifted."""
    count = 2 if isinstance(strip, Straight) else max(2, int(np.ceil(strip.length_m / 0.004)) + 1)
    places = [np.linspace(*ends, count)]
    places += [lift.middle_m + lift.half_length_m * np.linspace(-1.0, 1.0, 13) for lift in lifts]
    inside = np.unique(np.round(np.concatenate(places), 5))
    inside = inside[(inside > ends[0] + 1e-4) & (inside < ends[1] - 1e-4)]
    return np.concatenate([[ends[0]], inside, [ends[1]]])


def _wander(along: Array, max_m: float, rng: np.random.Generator) -> Array:
    """Draw the outward deviation (N,) at arc lengths (N,): mean 0, 0 at both ends, at most `max_m`."""
    length = along[-1]
    raw = np.zeros(len(along))
    for wavelength, share in _RIPPLES_M:
        nodes = int(np.ceil(2 * length / wavelength)) + 2
        raw += share * np.interp(along, 0.5 * wavelength * np.arange(nodes), rng.normal(size=nodes))
    raw = np.where(raw > 0, 1.6 * raw, 0.6 * raw)  # paint creeps out in tongues and stays back in shallow bays
    window = np.clip(np.minimum(along, length - along) / min(_RIPPLES_END_M, 0.5 * length), 0.0, 1.0)
    # Without its weighted mean the deviation is 0 on average, and the line as wide as the line sensor has it.
    raw = window * (raw - (window @ raw) / window.sum()) if window.sum() > 0 else window
    return raw * (max_m / max(np.abs(raw).max(), 1e-12))


def _mesh(name: str, strip: Strip, grid: tuple[Array, Array, Array], origin: Point2, surface: str) -> Mesh:
    """Return a mesh from arc lengths (N,), and offsets to the left and heights (N, K); `origin` is added to (u, v)."""
    along, across, z = grid
    count, columns = z.shape
    flat = [strip.at(along, across[:, k]) for k in range(columns)]
    vertices = [
        (float(flat[k][i, 0]), float(flat[k][i, 1]), float(z[i, k])) for i in range(count) for k in range(columns)
    ]
    uv = [(float(along[i] + origin[0]), float(across[i, k] + origin[1])) for i in range(count) for k in range(columns)]
    corners = (
        (i * columns + k, (i + 1) * columns + k, (i + 1) * columns + k + 1, i * columns + k + 1)
        for i in range(count - 1)
        for k in range(columns - 1)
    )
    faces = tuple(corners)
    face_uv = tuple(tuple(uv[vertex] for vertex in face) for face in faces)
    return Mesh(name, tuple(vertices), faces, face_uv, (surface,) * len(faces))
