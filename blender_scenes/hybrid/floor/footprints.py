"""The part of the floor that lies inside of bodies or below sheets, by their cuts just above the floor."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from blender_scenes.hybrid.floor.tiled_map import Tile
from blender_scenes.scene.description import Mesh
from symolo.core.arrays import Array, FloatImage

_CUT_M = 0.0005
"""Height of the cut: above tapes on the floor, below everything else that stands on it."""
_FLAT_M = 0.002
"""Height below which a mesh is paper that lies on the floor. A sheet hides the floor below it also where it lies on
another one beside, so there is a cut in the middle of each of three sheets."""
_CUTS_OF_PAPER_M = 0.0002, 0.0006, 0.001
_LINES = 8
"""Number of lines along x for each texel; a body covers exact parts of them."""
_DIGITS = 7
"""Decimal places [m] in which the ends of two neighbouring edges are equal."""


class Footprints:
    """Outlines of closed bodies, which may be open below; a mesh whose cut is not closed has no footprint."""

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        flat = [mesh for mesh in meshes if max(z for _, _, z in mesh.vertices) < _FLAT_M]
        standing = [mesh for mesh in meshes if mesh not in flat]
        self._cuts = [_edges(standing, _CUT_M), *(_edges(flat, height_m) for height_m in _CUTS_OF_PAPER_M)]

    def covered(self, tile: Tile) -> FloatImage:
        """Return the share (N, N, 1) of each texel, rows along y, that is inside of a body or below a sheet."""
        # The largest share, because the cuts of one mesh lie upon one another.
        return np.max([covered(edges, tile) for edges in self._cuts], axis=0)


def _edges(meshes: Sequence[Mesh], height_m: float) -> Array:
    """Return begin and end (K, 2, 2) of the edges of all closed outlines at a height."""
    outlines = [outline for mesh in meshes if _is_closed(outline := _outline(mesh, height_m))]
    return np.concatenate([np.zeros((0, 2, 2)), *outlines])


def _outline(mesh: Mesh, height_m: float) -> Array:
    """Return begin and end (K, 2, 2) of the edges of a mesh's cut, counter-clockwise around a body."""
    vertices = np.array(mesh.vertices)
    return np.array([edge for face in mesh.faces for edge in _cut(vertices[list(face)], height_m)]).reshape(-1, 2, 2)


def _cut(corners: Array, height_m: float) -> Iterator[tuple[Array, Array]]:
    """Yield the edges in which a face, counter-clockwise seen from outside, crosses the height of the cut."""
    falling, rising = [], []
    for a, b in pairwise([*corners, corners[0]]):
        if (a[2] > height_m) != (b[2] > height_m):
            at = a[:2] + (b[:2] - a[:2]) * (height_m - a[2]) / (b[2] - a[2])
            (rising if b[2] > a[2] else falling).append(at)
    # All of them lie on one line, so the pairs of a face with several do not matter for what is inside.
    yield from zip(falling, rising, strict=True)


def _is_closed(outline: Array) -> bool:
    """Return whether each edge ends where another one begins."""
    begins, ends = (sorted(map(tuple, np.round(outline[:, i], _DIGITS).tolist())) for i in (0, 1))
    return begins == ends


def covered(edges: Array, tile: Tile) -> FloatImage:
    """Return the share (N, N, 1) of each texel, rows along y, that is inside of areas.

    Args:
        edges: Begin and end (K, 2, 2) of the edges of the areas, counter-clockwise, in the coordinates of the tile.
        tile: Tile.
    """
    count = tile.texels
    begin, end = np.moveaxis((edges - tile.low) / tile.texel_m, 1, 0)
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    near = (high[:, 1] > 0) & (low[:, 1] < count) & (low[:, 0] < count)
    begin, end = begin[near, None], end[near, None]
    y = (np.arange(count * _LINES) + 0.5) / _LINES
    edge, line = np.nonzero((begin[..., 1] <= y) != (end[..., 1] <= y))
    (x0, y0), (x1, y1) = begin[edge, 0].T, end[edge, 0].T
    at = np.clip(x0 + (x1 - x0) * (y[line] - y0) / (y1 - y0), 0, count)
    # Edges run counter-clockwise around an area: from an edge that runs down, all that follows along x is inside,
    # up to an edge that runs up.
    enters = np.where(y1 < y0, 1.0, -1.0)
    texel = at.astype(int)
    change = np.zeros((count * _LINES, count + 2))
    np.add.at(change, (line, texel), enters * (1 - (at - texel)))
    np.add.at(change, (line, texel + 1), enters * (at - texel))
    inside = change.cumsum(axis=1)[:, :count].reshape(count, _LINES, count).mean(axis=1)
    return np.clip(inside, 0, 1)[..., None].astype(np.float32)
