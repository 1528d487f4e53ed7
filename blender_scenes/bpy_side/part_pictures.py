"""Pictures put together from their parts: light that few samples tell, and surfaces that need many.

Most of what the camera sees is the floor. What it reflects, its relief, and the light on it without robot and moving
obstacles are the same in every picture; they are worked out once, as maps. A picture's light is traced with few pixels
and samples, twice with the same random numbers, with and without what moves: their ratio, which has no noise where
nothing moves, is put on the map's light. What is not floor takes its light from the first of them. The surfaces of all
else are traced without light, which is cheap.
"""

from pathlib import Path

import cv2
import numpy as np

from blender_scenes.bpy_side.part_materials import COVER, MIDDLE_GREY
from blender_scenes.bpy_side.part_scenes import GRID_TURN_RAD, PartScenes, lies_on_the_floor
from blender_scenes.denoiser import Denoiser
from blender_scenes.description import FrameView
from blender_scenes.floor_sight import MIDDLE, FloorSight, filter_points
from blender_scenes.job import RenderJob
from blender_scenes.lens_warp import pinhole_picture
from blender_scenes.shutter import window
from blender_scenes.tiled_map import Image, Tile, TiledMap, Tiling, normals, without_holes
from blender_scenes.upsampling import reduced, upsampled
from configs.streams import stream

_REFLECTANCE = Tiling(texel_m=0.00025, levels=6, core=256)
_TEXELS_OF_A_PIXEL = 1.0
_IRRADIANCE = Tiling(texel_m=0.004, levels=5, core=112, margin=8)
_TEXEL_RAD = 0.018
"""Under which the camera sees one. Light changes over wider stretches than colour, whatever the size of pixels."""
_IRRADIANCE_SAMPLES = 8
_RELIEF = Tiling(texel_m=0.032, levels=3, core=56, margin=4)
"""Where light comes from changes over wider ones still."""
_TILT_RAD = np.radians(30.0)
_MOST_BYTES = 512 * 2**20
"""Of each map in memory; a lap of the dataset's arena in pictures of 640 x 480 stays below it."""
_LIGHT_WIDTH_PX = 160
"""More than that are shared by pixels of the picture."""
_GLANCE_BLUR_PX = 2.0
_WHOLLY = 0.99
_LEAST_WEIGHT = 1e-3
_CORNERS = (0, 2, -3, -1)
"""Of `filter_points`."""
_MOST_SHARE = 1.5
"""Of a still scene's light that may be left where something moves, or be thrown back by it."""
_LEAST_LIGHT = np.float32(1e-6)
_UP = (0.0, 0.0, 1.0)


class PartPictures:
    """Of one job, whose scene stands in Blender, configured by `engine.configure`."""

    def __init__(self, job: RenderJob, threads: int, scratch: Path) -> None:
        if job.sampling.parts is None:
            raise ValueError("the job's pictures are not to be put together from parts")
        self._samples, self._seed = job.sampling.parts, job.sampling.seed
        camera = pinhole_picture(job.camera).camera
        self._size = camera.width_px, camera.height_px
        self._times = _times(self._size)
        self._scenes = PartScenes(job.scene, scratch)
        self._denoised, self._denoised_fast = Denoiser(threads, "HIGH"), Denoiser(threads, "BALANCED")
        self._sight = FloorSight(camera, job.frames[0], window(job.shutter, job.camera).row_share)
        self._filter = filter_points(job.sampling.filter_width_px)
        floor = [mesh for mesh in job.scene.meshes if lies_on_the_floor(mesh.name)]
        ground = np.concatenate([np.array(mesh.vertices)[:, :2] for mesh in floor])
        self._bounds = ground.min(axis=0), ground.max(axis=0)
        surfaces = {name for mesh in floor for name in mesh.face_surface}
        self._has_relief = any(s.height_m is not None for s in job.scene.surfaces if s.name in surfaces)
        across_m, along_m = self._sight.pixel_m()
        self._reflectance_level = _level(np.sqrt(across_m * along_m) / _TEXELS_OF_A_PIXEL, _REFLECTANCE)
        self._irradiance_level = _level(self._sight.depth_m() * _TEXEL_RAD, _IRRADIANCE)
        self._reflectance = TiledMap(_REFLECTANCE, self._reflectance_tile, _MOST_BYTES, _with_upward_part)
        self._irradiance = TiledMap(_IRRADIANCE, self._irradiance_tile, _MOST_BYTES)
        self._relief = TiledMap(_RELIEF, self._relief_tile, _MOST_BYTES)

    def light(self, view: FrameView, seed: int) -> Image:
        """(H, W, 3) linear light of the pinhole picture of a view."""
        width, height = self._size
        small = width // self._times, height // self._times
        moved, still = self._scenes.light(small, self._samples.light, seed, view)
        # Other random numbers than those of the light.
        seen = self._scenes.surfaces(self._size, self._samples.surfaces, (seed + 1) % 2**31, view)
        nearness = 1 / np.maximum(seen["Depth"], 1e-3)
        cover = seen[COVER][..., :1]
        low = self._low_parts(moved, still, *(reduced(one, self._times) for one in (seen["Normal"], cover)))
        parts = upsampled(low, nearness, seen["Normal"])
        light, share, rest, glance = parts[..., :3], parts[..., 3:6], parts[..., 6:9], parts[..., 9:]
        on_floor = self._floor(view, cover[..., 0] > 0) * cover * share * glance
        return (on_floor + seen["DiffCol"] * light + rest).astype(np.float32)

    def _low_parts(self, moved: dict[str, Image], still: dict[str, Image], normal: Image, cover: Image) -> Image:
        """(h, w, 12): light, its share of the still scene's, gloss and all else, and what the floor's coat lets in."""
        diffuse = moved["DiffDir"] + moved["DiffInd"]
        rest = np.maximum(moved["Combined"] - moved["DiffCol"] * diffuse, 0)
        light, gone = (self._denoised(one, normal) for one in (diffuse, still["DiffDir"] + still["DiffInd"]))
        share = np.clip(light / np.maximum(gone, _LEAST_LIGHT), 0, _MOST_SHARE)
        shine = self._denoised_fast(rest, normal)
        return np.concatenate([light, share, shine, _smooth(moved["DiffCol"] / MIDDLE_GREY, cover)], axis=-1)

    def _floor(self, view: FrameView, needed: np.ndarray) -> Image:
        """(H, W, 3) light that the floor throws back without what moves, where it is needed."""
        width, height = self._size
        seen = np.zeros((height, width, 6 if self._has_relief else 3), np.float32)
        for level, rows, there in _bands(self._reflectance_level, needed):
            points = [
                _turned(self._clipped(self._sight.points(view, point, rows)), -GRID_TURN_RAD) for point in self._filter
            ]
            corners = [points[i][there] for i in _CORNERS]
            found = self._mean(level, points, np.concatenate(corners))
            if np.isnan(found[there]).any():
                # A pixel at the end of the floor, or at a corner of tiles, looks up what its corners do not tell.
                found = self._mean(level, points, np.concatenate([own[there] for own in points]))
            seen[rows] += np.where(there[..., None], found, 0)
        return seen[..., :3] * self._floor_light(view, needed, seen[..., 3:])

    def _floor_light(self, view: FrameView, needed: np.ndarray, normal: Image) -> Image:
        found = self._looked_up(self._irradiance, view, needed, 3)
        if not self._has_relief:
            return found
        lean = self._looked_up(self._relief, view, needed, 6)
        facing = normal[..., 2:] + normal[..., :1] * lean[..., :3] + normal[..., 1:2] * lean[..., 3:]
        return found * np.maximum(facing, 0)

    def _looked_up(self, of: TiledMap, view: FrameView, needed: np.ndarray, channels: int) -> Image:
        """(H, W, channels) of a map in the middle of each pixel, between its levels."""
        found = np.zeros((*needed.shape, channels), np.float32)
        offset = np.log2(_IRRADIANCE.texel_m / of.tiling.texel_m)
        exact = np.clip(self._irradiance_level + offset, 0, of.tiling.levels - 1)
        for level, rows, there in _bands(np.floor(exact), needed):
            points = self._clipped(self._sight.points(view, MIDDLE, rows))
            share = (exact[rows] - level)[..., None]
            looked_for = points[there]
            near = of.patch(level, looked_for).at(points)
            far = of.patch(min(level + 1, of.tiling.levels - 1), looked_for).at(points)
            found[rows] += np.where(there[..., None], near + share * (far - near), 0)
        return found

    def _mean(self, level: int, points: list[np.ndarray], needed: np.ndarray) -> Image:
        """(H, W, K) of what the map has at points (H, W, 2) of each; NaN where some are not among the needed."""
        patch = self._reflectance.patch(level, needed)
        total = patch.at(points[0])
        for more in points[1:]:
            total += patch.at(more)
        return total / np.float32(len(points))

    def _clipped(self, points: np.ndarray) -> np.ndarray:
        """Points on the floor; those that see none are put where it ends."""
        return np.clip(np.nan_to_num(points), *self._bounds)

    def _reflectance_tile(self, tile: Tile) -> Image:
        """(N, N, 5): reflectance, and x and y of the normal; (N, N, 3) without it where nothing has a relief."""
        colour, relief = self._scenes.reflectance(tile.widened())
        colour = colour[1:-1, 1:-1]
        if not self._has_relief:
            return colour
        normal = normals(relief[..., 0], relief[..., 1], tile.texel_m)
        return np.concatenate([colour, _turned(normal[..., :2], GRID_TURN_RAD)], axis=-1)

    def _irradiance_tile(self, tile: Tile) -> Image:
        return self._facing(_UP, tile, self._tile_seed("irradiance", tile))

    def _relief_tile(self, tile: Tile) -> Image:
        """(N, N, 6): what light on the floor grows by as its normal leans along x, and along y, per unit of the light.

        E(n) = E_z n_z + E_x n_x + E_y n_y for a little lean, of the vector irradiance; E_x follows from the light on a
        floor that is tilted.
        """
        seed = self._tile_seed("relief", tile)
        cosine, sine = float(np.cos(_TILT_RAD)), float(np.sin(_TILT_RAD))
        facings = _UP, (sine, 0.0, cosine), (0.0, sine, cosine)
        up, *tilted = (self._facing(facing, tile, seed) for facing in facings)
        leans = [(one / np.maximum(up, _LEAST_LIGHT) - cosine) / sine for one in tilted]
        return np.concatenate(leans, axis=-1)

    def _facing(self, facing: tuple[float, float, float], tile: Tile, seed: int) -> Image:
        light = without_holes(self._scenes.irradiance(tile, _IRRADIANCE_SAMPLES, seed, facing))
        return self._denoised(light, np.broadcast_to(np.array(_UP, np.float32), light.shape))

    def _tile_seed(self, what: str, tile: Tile) -> int:
        level, i, j = (number % 2**32 for number in tile.key)
        return int(stream(self._seed, "path tracing", what, level, i, j).integers(2**31))


def _times(size: tuple[int, int]) -> int:
    """How many pixels of a picture, each way, share one of its light's."""
    times = 1
    while size[0] // (2 * times) >= _LIGHT_WIDTH_PX and not any(px % (2 * times) for px in size):
        times *= 2
    return times


def _with_upward_part(tile: Image) -> Image:
    """(N, N, 6) of (N, N, 5) as `_reflectance_tile` has them; z of the normal follows from x and y."""
    if tile.shape[-1] == 3:
        return tile
    upward = np.sqrt(np.maximum(1 - (tile[..., 3:] ** 2).sum(axis=-1, keepdims=True), 0))
    return np.concatenate([tile, upward], axis=-1)


def _smooth(glance: Image, cover: Image) -> Image:
    """What the floor's coat lets through, which follows from the angle of sight, without the grain of its gloss."""
    whole = (cover > _WHOLLY).astype(np.float32)
    total, weight = (cv2.GaussianBlur(one, (0, 0), _GLANCE_BLUR_PX) for one in (glance * whole, whole))
    weight = weight.reshape(cover.shape)
    return np.where(weight > _LEAST_WEIGHT, total / np.maximum(weight, _LEAST_WEIGHT), glance)


def _turned(vectors: np.ndarray, by_rad: float) -> np.ndarray:
    """Vectors (..., 2) turned counter-clockwise."""
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)


def _level(texel_m: np.ndarray, tiling: Tiling) -> np.ndarray:
    """(H, W) level whose texels are that large, with its fraction; NaN above the horizon."""
    return np.clip(np.log2(texel_m / tiling.texel_m), 0, tiling.levels - 1)


def _bands(level: np.ndarray, needed: np.ndarray) -> list[tuple[int, slice, np.ndarray]]:
    """For each whole level that is needed: the rows it is needed in, and in which of their pixels."""
    whole = np.where(needed & np.isfinite(level), np.floor(np.nan_to_num(level)), -1).astype(int)
    bands = []
    for number in np.unique(whole[whole >= 0]).tolist():
        rows = np.flatnonzero((whole == number).any(axis=1))
        band = slice(int(rows[0]), int(rows[-1]) + 1)
        bands.append((number, band, whole[band] == number))
    return bands
