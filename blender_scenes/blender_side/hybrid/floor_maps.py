"""Maps of the floor without what moves: its reflectance, roughness and relief, and the light on it.

They are the same in every image. Each is made of tiles, which are made when they first come into view.
"""

from collections.abc import Sequence

import numpy as np

from blender_scenes.blender_side.hybrid.scenes import GRID_TURN_RAD, HybridScenes, lies_on_the_floor
from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.hybrid.floor.footprints import Footprints
from blender_scenes.hybrid.floor.layers import FloorLayers
from blender_scenes.hybrid.floor.light import without_noise
from blender_scenes.hybrid.floor.relief import TILTS, lean, lean_without, shading
from blender_scenes.hybrid.floor.sight import MIDDLE, FilterPoint, FloorSight, filter_points
from blender_scenes.hybrid.floor.tiled_map import Tile, TiledMap, Tiling, normals
from blender_scenes.hybrid.shadows.small_lights import SmallLight
from blender_scenes.render.job import RenderJob
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage
from symolo.core.random_streams import stream

_LEVELS, _CORE = 6, 128
"""Tiling of the reflectance map; the size of its texels follows from the nearest floor, within limits."""
_MIN_TEXEL_M, _MAX_TEXEL_M = 0.00025, 0.004
_TEXEL_PX = 1.2
"""Width of a texel in pixels; smaller ones take more time than the images gain."""
_SLANT = 4.0
"""Maximum ratio of length and width of a pixel on the floor; for longer pixels the texels are larger."""
_STEEP = 3.0
"""Ratio of length and width up to which a pixel's filter has 3 x 3 points; beyond it has twice as many."""
_IRRADIANCE = Tiling(texel_m=0.004, levels=5, core=112, margin=8)
_TEXEL_RAD = 0.009
"""Angle of a light texel seen from the camera, at least a pixel; light varies over larger distances than colour."""
_IRRADIANCE_SAMPLES = 8
_RELIEF = Tiling(texel_m=0.032, levels=3, core=56, margin=4)
"""Tiling of the map of the light's direction, which varies over even larger distances."""
_MAX_BYTES = 640 * 2**20
"""Maximum size of each map in memory; a lap of the dataset's arena in images of 640 x 480 needs less."""
_CORNERS = (0, 2, -3, -1)
"""Indices of the corners in `filter_points`."""
_EVERY = 4
"""Step of the rows of pixels from which the needed tiles follow; the other rows rarely need more."""
_IN_M = 0.05
"""If the corners of an image are at least this far inside the border of the floor, the whole image is."""
_MIN_LIGHT = np.float32(1e-6)
_UP = (0.0, 0.0, 1.0)

Hidden = tuple[FloatImage, SmallLight]
"""Part (H, W, 3) of the light on the floor that comes from a light and that what moves hides."""


class FloorMaps:
    """The maps of a job whose scene is in Blender."""

    def __init__(self, job: RenderJob, scenes: HybridScenes, sight: FloorSight, denoised: Denoiser) -> None:
        self._scenes, self._seed, self._sight, self._denoised = scenes, job.sampling.seed, sight, denoised
        floor = [mesh for mesh in job.scene.meshes if lies_on_the_floor(mesh.name)]
        clear = {surface.name for surface in job.scene.surfaces if surface.transmission}
        standing = [mesh for mesh in job.scene.meshes if not lies_on_the_floor(mesh.name)]
        self._layers = FloorLayers(floor, GRID_TURN_RAD)
        self._footprints = Footprints([mesh for mesh in standing if not clear & set(mesh.face_surface)])
        ground = np.concatenate([np.array(mesh.vertices)[:, :2] for mesh in floor])
        self._bounds = ground.min(axis=0).astype(np.float32), ground.max(axis=0).astype(np.float32)
        surfaces = {name for mesh in floor for name in mesh.face_surface}
        self._has_relief = any(s.height_m is not None for s in job.scene.surfaces if s.name in surfaces)
        across_m, along_m = sight.pixel_m()
        few, many = (filter_points(job.sampling.filter_width_px, squares) for squares in (1, 2))
        self.filters = (few, ~(slanted := along_m > _STEEP * across_m)), (many, slanted)
        """Points of the pixels' filter, and the pixels (H, W) that have them."""
        texel_m = _TEXEL_PX * np.maximum(across_m, along_m / _SLANT)
        finest_m = max(float(np.nanmin(texel_m, initial=_MAX_TEXEL_M)), _MIN_TEXEL_M)
        # Rounded, because a different last digit on another processor would move all texels.
        reflectance = Tiling(float(f"{finest_m:.3g}"), _LEVELS, _CORE)
        self._reflectance_level = _level(texel_m, reflectance)
        self._irradiance_level = _level(np.maximum(sight.depth_m() * _TEXEL_RAD, across_m), _IRRADIANCE)
        self._reflectance = TiledMap(reflectance, self._reflectance_tile, _MAX_BYTES, _with_upward_part)
        self._irradiance = TiledMap(_IRRADIANCE, self._irradiance_tile, _MAX_BYTES)
        self._relief = TiledMap(_RELIEF, self._relief_tile, _MAX_BYTES)

    def surface(self, view: FrameView, needed: np.ndarray) -> FloatImage:
        """Return (H, W, 7), where needed: the floor's reflectance, roughness, and normal; (H, W, 4) without relief."""
        seen = np.zeros((*needed.shape, 7 if self._has_relief else 4), np.float32)
        for filtered, where in self.filters:
            for level, rows, mask in _bands(self._reflectance_level, needed & where):
                points = [_turned(self.ground(view, point, rows), -GRID_TURN_RAD) for point in filtered]
                corners = [points[i][::_EVERY][mask[::_EVERY]] for i in _CORNERS]
                values = self._mean(level, points, np.concatenate(corners))
                if np.isnan(values[..., 0][mask]).any():
                    # Other rows need more tiles: at the end of the floor, or at the corner of a tile.
                    values = self._mean(level, points, np.concatenate([some[mask] for some in points]))
                np.copyto(seen[rows], values, where=mask[..., None])
        return seen

    def light(self, view: FrameView, needed: np.ndarray, normal: FloatImage, hidden: Sequence[Hidden]) -> FloatImage:
        """Return the light (H, W, 3) on the floor without what moves; relief is lit as by the light that remains."""
        points = self.ground(view, MIDDLE)
        light = self._looked_up(self._irradiance, points, needed, 3)
        if not self._has_relief:
            return light
        leans = self._looked_up(self._relief, points, needed, 6)
        if hidden:
            leans = lean_without(leans, [(part, lamp.lean_at(points)) for part, lamp in hidden])
        return light * shading(normal, leans)

    def _looked_up(self, tiled: TiledMap, points: FloatImage, needed: np.ndarray, channels: int) -> FloatImage:
        """Return (H, W, channels) of a map at each pixel's point, interpolated between its levels."""
        values = np.zeros((*needed.shape, channels), np.float32)
        offset = np.log2(_IRRADIANCE.texel_m / tiled.tiling.texel_m)
        exact = np.clip(self._irradiance_level + offset, 0, tiled.tiling.levels - 1)
        for level, rows, mask in _bands(np.floor(exact), needed):
            share = (exact[rows] - level)[..., None]
            visible = points[rows][mask]
            near = tiled.patch(level, visible).at(points[rows])
            far = tiled.patch(min(level + 1, tiled.tiling.levels - 1), visible).at(points[rows])
            np.copyto(values[rows], near + share * (far - near), where=mask[..., None])
        return values

    def _mean(self, level: int, points: list[np.ndarray], needed: np.ndarray) -> FloatImage:
        """Return the mean (H, W, K) of the map at some points (H, W, 2) per pixel; NaN outside of the needed tiles."""
        patch = self._reflectance.patch(level, needed)
        total = patch.at(points[0])
        for more in points[1:]:
            total += patch.at(more)
        return total / np.float32(len(points))

    def ground(self, view: FrameView, point: FilterPoint, rows: slice = slice(None)) -> FloatImage:
        """Return points on the floor (rows, W, 2); those of pixels that see no floor are moved to its border."""
        low, high = self._bounds
        points = self._sight.points(view, point, rows)
        corners = points[[0, 0, -1, -1], [0, -1, 0, -1]]
        if not ((corners > low + _IN_M) & (corners < high - _IN_M)).all():
            np.fmin(np.fmax(points, low, out=points), high, out=points)
        return points

    def _reflectance_tile(self, tile: Tile) -> FloatImage:
        """Return (N, N, 6): reflectance, roughness, and x and y of the normal; (N, N, 4) for a floor without relief."""
        colour, data = self._scenes.reflectance(tile.widened())
        texels = self._layers.blended(tile, np.concatenate([colour, data[..., 2:]], axis=-1), data[..., 1])
        if not self._has_relief:
            return texels
        normal = normals(data[..., 0], data[..., 1], tile.texel_m)
        return np.concatenate([texels, _turned(normal[..., :2], GRID_TURN_RAD)], axis=-1)

    def _irradiance_tile(self, tile: Tile) -> FloatImage:
        light = self._light_on(tile, "irradiance", _UP)
        return without_noise(light, self._free(tile, light), self._denoised, keeps_mean=True)

    def _relief_tile(self, tile: Tile) -> FloatImage:
        """Return the lean (N, N, 6) of the light on the floor."""
        level, *tilted = (self._light_on(tile, "relief", direction) for direction in (_UP, *TILTS))
        free = self._free(tile, level)
        up = np.maximum(without_noise(level, free, self._denoised), _MIN_LIGHT)
        return lean([without_noise(light, free, self._denoised) / up for light in tilted])

    def _light_on(self, tile: Tile, what: str, facing: tuple[float, float, float]) -> FloatImage:
        """Return the light with noise, from the same random numbers for every direction of the floor."""
        level, i, j = (number % 2**32 for number in tile.key)
        seed = int(stream(self._seed, "path tracing", what, level, i, j).integers(2**31))
        return self._scenes.irradiance(tile, _IRRADIANCE_SAMPLES, seed, facing)

    def _free(self, tile: Tile, level: FloatImage) -> FloatImage:
        """Return the share (N, N, 1) of texels that is not inside of bodies, where a level floor is dark."""
        lit = level.sum(axis=-1, keepdims=True) > 0
        return np.where(lit, 1 - self._footprints.covered(tile), 0).astype(np.float32)


def _with_upward_part(tile: FloatImage) -> FloatImage:
    """Return (N, N, 7) from (N, N, 6) of `_reflectance_tile`, with z of the normal."""
    if tile.shape[-1] == 4:
        return tile
    upward = np.sqrt(np.maximum(1 - (tile[..., 4:] ** 2).sum(axis=-1, keepdims=True), 0))
    return np.concatenate([tile, upward], axis=-1)


def _turned(vectors: np.ndarray, by_rad: float) -> np.ndarray:
    """Return vectors (..., 2) turned counter-clockwise."""
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.moveaxis(np.stack([cosine * x - sine * y, sine * x + cosine * y]), 0, -1)


def _level(texel_m: np.ndarray, tiling: Tiling) -> np.ndarray:
    """Return the level (H, W), with a fraction, whose texels have that size; NaN above the horizon."""
    return np.clip(np.log2(texel_m / tiling.texel_m), 0, tiling.levels - 1)


def _bands(level: np.ndarray, needed: np.ndarray) -> list[tuple[int, slice, np.ndarray]]:
    """Return for each level that is needed: its number, the rows in which it is needed, and a mask of their pixels."""
    floored = np.where(needed & np.isfinite(level), np.floor(np.nan_to_num(level)), -1).astype(int)
    bands = []
    for number in np.unique(floored[floored >= 0]).tolist():
        rows = np.flatnonzero((floored == number).any(axis=1))
        band = slice(int(rows[0]), int(rows[-1]) + 1)
        bands.append((number, band, floored[band] == number))
    return bands
