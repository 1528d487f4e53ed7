"""Maps of a plane as tiles of several resolutions, each made when it is first needed.

A tile depends only on its place, so that all processes get the same tile.
"""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import FloatImage

_STEPS = 32
"""Steps of OpenCV's bilinear interpolation between two texels."""


@dataclass(frozen=True)
class Tile:
    """A square piece of the plane."""

    low: tuple[float, float]
    """Lower left corner [m]."""
    texel_m: float
    texels: int
    """Number of texels along a side."""
    key: tuple[int, int, int]
    """Level, column and row."""

    def widened(self) -> "Tile":
        """Return the tile with another texel on each side."""
        x, y = self.low
        return Tile((x - self.texel_m, y - self.texel_m), self.texel_m, self.texels + 2, self.key)


Make = Callable[[Tile], FloatImage]
"""Function that makes the texels (N, N, K) of a tile, rows along y."""
Unpack = Callable[[FloatImage], FloatImage]
"""Function that makes the values of a patch from the stored texels of a tile."""


@dataclass(frozen=True)
class Tiling:
    """Division of a plane into square tiles on several levels of resolution."""

    texel_m: float
    """Size of a texel on level 0; it doubles from level to level."""
    levels: int
    """Number of levels."""
    core: int
    """Number of texels along a side of a tile without its margin."""
    margin: int = 0
    """Number of further texels on each side, over which a tile blends into its neighbours."""

    def side(self) -> int:
        """Return the number of texels along a side of a tile with its margins."""
        return self.core + 2 * self.margin

    def shares(self) -> FloatImage:
        """Return the weight (side,) of a tile along an axis; the weights of all tiles sum to 1 everywhere."""
        if not self.margin:
            return np.ones(self.core, np.float32)
        rise = (np.arange(2 * self.margin) + 0.5) / (2 * self.margin)
        flat = np.ones(self.side() - 4 * self.margin)
        return np.concatenate([rise, flat, rise[::-1]]).astype(np.float32)


@dataclass(frozen=True)
class MapPatch:
    """Neighbouring tiles of one level as one image."""

    first: NDArray[np.int64]
    """Column and row of its first texel on the plane."""
    texel_m: float
    texels: FloatImage
    """(H, W, K), NaN where no tile was needed."""

    def at(self, points: NDArray[np.floating]) -> FloatImage:
        """Return the interpolated values (M, N, K) at points (M, N, 2) [m]."""
        # Rounding to OpenCV's steps before the corner is subtracted makes the result independent of the corner.
        where = points * (_STEPS / self.texel_m)
        where -= 0.5 * _STEPS
        np.rint(where, out=where)
        where /= _STEPS
        where -= self.first.astype(where.dtype)
        u, v = (np.ascontiguousarray(where[..., axis], np.float32) for axis in (0, 1))
        beyond = (np.nan,) * 4
        values = cv2.remap(self.texels, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=beyond)
        return values.astype(np.float32, copy=False)


class TiledMap:
    """A map whose tiles are made when they are first looked up; a full one drops tiles that were not used lately."""

    def __init__(self, tiling: Tiling, make: Make, max_bytes: int, unpack: Unpack = np.asarray) -> None:
        """Keep tiles as 16-bit floats, up to so many bytes; `unpack` makes from them the values of a patch."""
        self.tiling = tiling
        self._make, self._max_bytes, self._unpack = make, max_bytes, unpack
        self._tiles: OrderedDict[tuple[int, int, int], NDArray[np.float16]] = OrderedDict()
        self._bytes = 0
        self._last: dict[int, tuple[set[tuple[int, int]], MapPatch]] = {}
        """Tiles and patch of the last look-up on each level; an image needs mostly the same tiles as the one before."""

    def patch(self, level: int, points: NDArray[np.floating]) -> MapPatch:
        """Return a patch in which these points (..., 2) [m] can be looked up."""
        texel_m = self.tiling.texel_m * 2**level
        tiles = _tiles_at(points.reshape(-1, 2) / texel_m, self.tiling.margin + 2, self.tiling.core)
        present, patch = self._last.get(level, (set(), None))
        if patch is None or not set(map(tuple, tiles.tolist())) <= present:
            present, patch = self._laid_out(level, tiles, present, patch)
            self._last[level] = present, patch
        return patch

    def _laid_out(
        self, level: int, needed: NDArray[np.int64], present: set[tuple[int, int]], last: MapPatch | None
    ) -> tuple[set[tuple[int, int]], MapPatch]:
        """Return the tiles of a new patch, and the patch; texels that the last patch has as well are copied."""
        tiling, texel_m = self.tiling, self.tiling.texel_m * 2**level
        first, beyond = needed.min(axis=0), needed.max(axis=0) + 1
        tiles = {(i, j) for i, j in needed.tolist()}
        # Tiles that blend into each other are not copied: a sum in another order would not be exactly the same.
        old = set() if tiling.margin else present
        reused = {tile for tile in old if (first <= tile).all() and (tile < beyond).all()}
        for tile in sorted(reused):
            self._use(level, *tile)
        new = {tile: self._unpack(self._tile(level, *tile).astype(np.float32)) for tile in sorted(tiles - reused)}
        columns, rows = (beyond - first) * tiling.core + 2 * tiling.margin
        channels = next(iter(new.values())).shape[-1]
        texels = np.full((rows, columns, channels), np.nan if not tiling.margin else 0.0, np.float32)
        if last is not None and reused:
            _copy_common(last, texels, first * tiling.core)
        share, side = tiling.shares(), tiling.side()
        for (i, j), tile in new.items():
            x, y = (i - first[0]) * tiling.core, (j - first[1]) * tiling.core
            area = texels[y : y + side, x : x + side]
            if tiling.margin:
                area += tile * (share[:, None] * share)[..., None]
            else:
                area[...] = tile
        return reused | tiles, MapPatch(first * tiling.core - tiling.margin, texel_m, texels)

    def _use(self, level: int, i: int, j: int) -> None:
        """Mark a tile as used last, so that others are dropped before it."""
        if (level, i, j) in self._tiles:
            self._tiles.move_to_end((level, i, j))

    def _tile(self, level: int, i: int, j: int) -> NDArray[np.float16]:
        key = level, i, j
        if key in self._tiles:
            self._use(*key)
            return self._tiles[key]
        tiling, texel_m = self.tiling, self.tiling.texel_m * 2**level
        low = (i * tiling.core - tiling.margin) * texel_m, (j * tiling.core - tiling.margin) * texel_m
        texels = self._make(Tile(low, texel_m, tiling.side(), key)).astype(np.float16)
        self._tiles[key] = texels
        self._bytes += texels.nbytes
        while self._bytes > self._max_bytes and len(self._tiles) > 1:
            _, dropped = self._tiles.popitem(last=False)
            self._bytes -= dropped.nbytes
        return texels


def _tiles_at(texels: NDArray[np.floating], reach: int, core: int) -> NDArray[np.int64]:
    """Return the sorted columns and rows (T, 2) of the tiles that contain texels (N, 2) or are within their reach."""
    ends = [[np.floor((at + shift) / core).astype(np.int64) for shift in (-reach, reach)] for at in texels.T.copy()]
    first = np.array([low.min() for low, _ in ends])
    count = np.array([high.max() for _, high in ends]) - first + 1
    touched = np.zeros(count, bool)
    for column in ends[0]:
        for row in ends[1]:
            touched[column - first[0], row - first[1]] = True
    return np.argwhere(touched) + first


def _copy_common(patch: MapPatch, texels: FloatImage, first: NDArray[np.int64]) -> None:
    """Copy the part of a patch that lies on texels (H, W, K), the first of which is `first` on the plane."""
    patch_size, size = np.array(patch.texels.shape[1::-1]), np.array(texels.shape[1::-1])
    low, high = np.maximum(patch.first, first), np.minimum(patch.first + patch_size, first + size)
    (x, y), (to_x, to_y), (columns, rows) = low - patch.first, low - first, high - low
    texels[to_y : to_y + rows, to_x : to_x + columns] = patch.texels[y : y + rows, x : x + columns]


def normals(height_m: FloatImage, surfaces: FloatImage, texel_m: float) -> FloatImage:
    """Return unit normals (N-2, N-2, 3) of a relief (N, N) of several `surfaces` (N, N); flat where two meet."""
    slopes = []
    for axis in (1, 0):
        before, after = (np.roll(height_m, shift, axis) for shift in (1, -1))
        same = (np.roll(surfaces, 1, axis) == surfaces) & (np.roll(surfaces, -1, axis) == surfaces)
        slopes.append(np.where(same, (after - before) / (2 * texel_m), 0)[1:-1, 1:-1])
    across = np.stack([-slopes[0], -slopes[1], np.ones_like(slopes[0])], axis=-1)
    return (across / np.linalg.norm(across, axis=-1, keepdims=True)).astype(np.float32)
