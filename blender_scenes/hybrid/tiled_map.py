"""What lies on a plane as tiles of several finenesses, each made when it is first looked at.

A tile depends on its place alone, so that whichever process looks at it first sees the same.
"""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]

_STEPS = 32
"""Of OpenCV's bilinear interpolation from one texel to the next."""


@dataclass(frozen=True)
class Tile:
    """A square piece of the plane."""

    low: tuple[float, float]
    """Lower left corner [m]."""
    texel_m: float
    texels: int
    """Along a side."""
    key: tuple[int, int, int]
    """Level, column and row."""

    def widened(self) -> "Tile":
        """By a texel on each side."""
        x, y = self.low
        return Tile((x - self.texel_m, y - self.texel_m), self.texel_m, self.texels + 2, self.key)


Make = Callable[[Tile], Image]
"""(N, N, K) of a tile, rows along y."""
Unpack = Callable[[Image], Image]


def _as_it_is(tile: Image) -> Image:
    return tile


@dataclass(frozen=True)
class Tiling:
    texel_m: float
    """Of level 0; that of each level is twice the one before."""
    levels: int
    core: int
    """Texels along a side of a tile."""
    margin: int = 0
    """More of them on each side, over which a tile passes into its neighbours."""

    def side(self) -> int:
        return self.core + 2 * self.margin

    def shares(self) -> Image:
        """(side,) what a tile counts for along an axis; those of all tiles together are 1 everywhere."""
        if not self.margin:
            return np.ones(self.core, np.float32)
        rise = (np.arange(2 * self.margin) + 0.5) / (2 * self.margin)
        flat = np.ones(self.side() - 4 * self.margin)
        return np.concatenate([rise, flat, rise[::-1]]).astype(np.float32)


@dataclass(frozen=True)
class MapPatch:
    """Tiles of one level side by side."""

    first: NDArray[np.int64]
    """Column and row of its first texel among all of the plane's."""
    texel_m: float
    texels: Image
    """(H, W, K), NaN where no tile was asked for."""

    def at(self, points: NDArray[np.floating]) -> Image:
        """(..., K) between the texels at points (M, N, 2) [m]."""
        # OpenCV's own steps, taken before the patch's corner is: single precision holds them, wherever that is.
        where = points * (_STEPS / self.texel_m)
        where -= 0.5 * _STEPS
        np.rint(where, out=where)
        where /= _STEPS
        where -= self.first.astype(where.dtype)
        u, v = (np.ascontiguousarray(where[..., axis], np.float32) for axis in (0, 1))
        beyond = (np.nan,) * 4
        found = cv2.remap(self.texels, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=beyond)
        return found.astype(np.float32, copy=False)


class TiledMap:
    def __init__(self, tiling: Tiling, make: Make, max_bytes: int, unpack: Unpack = _as_it_is) -> None:
        """Tiles are kept as 16-bit floats, up to so many bytes; `unpack` makes of them what is looked up."""
        self.tiling = tiling
        self._make, self._max_bytes, self._unpack = make, max_bytes, unpack
        self._tiles: OrderedDict[tuple[int, int, int], NDArray[np.float16]] = OrderedDict()
        self._bytes = 0
        self._last: dict[int, tuple[set[tuple[int, int]], MapPatch]] = {}
        """Of each level: a picture looks at much the same tiles as the one before."""

    def patch(self, level: int, points: NDArray[np.floating]) -> MapPatch:
        """Where these points (..., 2) [m] can be looked up."""
        own = self.tiling
        texel_m = own.texel_m * 2**level
        reach = own.margin + 2
        found = _tiles_at(points.reshape(-1, 2) / texel_m, reach, own.core)
        wanted = {(i, j) for i, j in found.tolist()}
        there, patch = self._last.get(level, (set(), None))
        if patch is None or not wanted <= there:
            there, patch = self._laid_out(level, found, there, patch)
            self._last[level] = there, patch
        return patch

    def _laid_out(
        self, level: int, found: NDArray[np.int64], there: set[tuple[int, int]], last: MapPatch | None
    ) -> tuple[set[tuple[int, int]], MapPatch]:
        """The tiles side by side, and the patch of them; what the last patch has of the same stretch is copied."""
        own, texel_m = self.tiling, self.tiling.texel_m * 2**level
        first, beyond = found.min(axis=0), found.max(axis=0) + 1
        wanted = {(i, j) for i, j in found.tolist()}
        # Where tiles pass into each other, sums of the same in another order are not quite the same.
        old = set() if own.margin else there
        kept = {tile for tile in old if (first <= tile).all() and (tile < beyond).all()}
        for tile in sorted(kept):
            self._use(level, *tile)
        made = {tile: self._unpack(self._tile(level, *tile).astype(np.float32)) for tile in sorted(wanted - kept)}
        columns, rows = (beyond - first) * own.core + 2 * own.margin
        channels = next(iter(made.values())).shape[-1]
        texels = np.full((rows, columns, channels), np.nan if not own.margin else 0.0, np.float32)
        if last is not None and kept:
            _copy_common(last, texels, first * own.core)
        share = own.shares()
        for (i, j), tile in made.items():
            x, y = (i - first[0]) * own.core, (j - first[1]) * own.core
            place = texels[y : y + own.side(), x : x + own.side()]
            if own.margin:
                place += tile * (share[:, None] * share)[..., None]
            else:
                place[...] = tile
        return kept | wanted, MapPatch(first * own.core - own.margin, texel_m, texels)

    def _use(self, level: int, i: int, j: int) -> None:
        """So that it is among the last to go."""
        if (level, i, j) in self._tiles:
            self._tiles.move_to_end((level, i, j))

    def _tile(self, level: int, i: int, j: int) -> NDArray[np.float16]:
        key = level, i, j
        if key in self._tiles:
            self._use(*key)
            return self._tiles[key]
        own, texel_m = self.tiling, self.tiling.texel_m * 2**level
        low = (i * own.core - own.margin) * texel_m, (j * own.core - own.margin) * texel_m
        made = self._make(Tile(low, texel_m, own.side(), key)).astype(np.float16)
        self._tiles[key] = made
        self._bytes += made.nbytes
        while self._bytes > self._max_bytes and len(self._tiles) > 1:
            _, dropped = self._tiles.popitem(last=False)
            self._bytes -= dropped.nbytes
        return made


def _tiles_at(texels: NDArray[np.floating], reach: int, core: int) -> NDArray[np.int64]:
    """(T, 2) columns and rows, sorted, of the tiles that hold texels (N, 2) or lie within their reach."""
    ends = [[np.floor((at + way) / core).astype(np.int64) for way in (-reach, reach)] for at in texels.T.copy()]
    first = np.array([low.min() for low, _ in ends])
    count = np.array([high.max() for _, high in ends]) - first + 1
    touched = np.zeros(count, bool)
    for column in ends[0]:
        for row in ends[1]:
            touched[column - first[0], row - first[1]] = True
    return np.argwhere(touched) + first


def _copy_common(patch: MapPatch, texels: Image, first: NDArray[np.int64]) -> None:
    """What a patch has in common with texels (H, W, K), the first of which is `first` among all of the plane's."""
    theirs, ours = np.array(patch.texels.shape[1::-1]), np.array(texels.shape[1::-1])
    low, high = np.maximum(patch.first, first), np.minimum(patch.first + theirs, first + ours)
    (x, y), (to_x, to_y), (columns, rows) = low - patch.first, low - first, high - low
    texels[to_y : to_y + rows, to_x : to_x + columns] = patch.texels[y : y + rows, x : x + columns]


def without_holes(light: Image, level: Image) -> Image:
    """Light (N, N, K) on a floor, with that around it put where something stands.

    What is beside a box would else be darkened by what is below it. Texels at the border of a hole are half below it.

    Args:
        light: The floor may be tilted, and dark where it is turned away.
        level: The same of a level floor, which is dark where something stands alone.
    """
    free = (level.sum(axis=-1) > 0).astype(np.float32)[..., None]
    if free.all() or not free.any():
        return light
    return np.where(free > 0, light, _spread(light * free, free)).astype(np.float32)


def _spread(weighted: Image, weight: Image) -> Image:
    """Values times weight (N, N, K) brought to where there is no weight, by means of ever larger squares."""
    if weight.all() or min(weight.shape[:2]) == 1:
        return weighted / np.maximum(weight, 1e-9)
    height, width = weight.shape[:2]
    half = (width + 1) // 2, (height + 1) // 2
    small, small_weight = (
        cv2.resize(a, half, interpolation=cv2.INTER_AREA).astype(np.float32) for a in (weighted, weight)
    )
    small_weight = small_weight.reshape(*small.shape[:2], 1)
    far = cv2.resize(_spread(small, small_weight), (width, height), interpolation=cv2.INTER_LINEAR)
    return np.where(weight > 0, weighted / np.maximum(weight, 1e-9), far).astype(np.float32)


def normals(height_m: Image, whose: Image, texel_m: float) -> Image:
    """(N-2, N-2, 3) unit normals of a relief (N, N); flat where two surfaces meet, whose heights are their own."""
    slopes = []
    for axis in (1, 0):
        before, after = (np.roll(height_m, way, axis) for way in (1, -1))
        same = (np.roll(whose, 1, axis) == whose) & (np.roll(whose, -1, axis) == whose)
        slopes.append(np.where(same, (after - before) / (2 * texel_m), 0)[1:-1, 1:-1])
    across = np.stack([-slopes[0], -slopes[1], np.ones_like(slopes[0])], axis=-1)
    return (across / np.linalg.norm(across, axis=-1, keepdims=True)).astype(np.float32)
