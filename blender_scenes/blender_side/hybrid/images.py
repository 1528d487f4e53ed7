"""Pictures put together from their parts: light that few samples tell, and surfaces that need many.

Most of what the camera sees is the floor. What it reflects, its relief, and the light on it without robot and moving
obstacles are the same in every picture; they are worked out once, as maps. A picture's light is traced with very few
pixels and samples, twice with the same random numbers, with and without what moves: their ratio, which has no noise
where nothing moves, is put on the map's light. The upper rows, where the floor is far and other things stand, are
traced once more with more pixels; what is not floor takes its light from there. Its surfaces are traced without
bounces, which is cheap, and in those rows alone that it reaches down to.
"""

from pathlib import Path

import numpy as np

from blender_scenes.blender_side.hybrid.materials import COVER, MIDDLE_GREY
from blender_scenes.blender_side.hybrid.scenes import GRID_TURN_RAD, HybridScenes, Passes, lies_on_the_floor
from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.hybrid.floor_sight import MIDDLE, FilterPoint, FloorSight, filter_points
from blender_scenes.hybrid.guided_filter import local_lines
from blender_scenes.hybrid.lowest_row import EdgesInSight
from blender_scenes.hybrid.tiled_map import Image, Tile, TiledMap, Tiling, normals, without_holes
from blender_scenes.hybrid.upsampling import reduced, upsampled
from blender_scenes.render.job import RenderJob
from blender_scenes.scene.description import Mesh, Panel
from blender_scenes.scene.meshes import rectangle
from sensors.camera.lens_warp import LIGHT_WIDTH_PX, pinhole_image
from sensors.camera.shutter import window
from sensors.camera.views import FrameView
from symolo.core.random_streams import stream

_LEVELS, _CORE = 6, 128
"""Of the reflectance, whose finest texels are what the nearest floor asks for, within limits."""
_MIN_TEXEL_M, _MAX_TEXEL_M = 0.00025, 0.004
_TEXEL_PX = 1.2
"""Across; finer ones cost a run more than they bring its pictures."""
_SLANT = 4.0
"""Times as long as wide may be what a pixel sees of the floor; of what is longer, texels are as much wider."""
_STEEP = 3.0
"""Less slanted than that, a pixel's filter is told by 3 x 3 points, else by twice as many."""
_IRRADIANCE = Tiling(texel_m=0.004, levels=5, core=112, margin=8)
_TEXEL_RAD = 0.009
"""Under which the camera sees one, no smaller than a pixel. Light changes over wider stretches than colour."""
_IRRADIANCE_SAMPLES = 8
_RELIEF = Tiling(texel_m=0.032, levels=3, core=56, margin=4)
"""Where light comes from changes over wider ones still."""
_TILT_RAD = np.radians(15.0)
_MAX_BYTES = 640 * 2**20
"""Of each map in memory; a lap of the dataset's arena in pictures of 640 x 480 stays below it."""
_NEAR_WIDTH_PX, _FAR_WIDTH_PX = LIGHT_WIDTH_PX, 4 * LIGHT_WIDTH_PX
"""Of the light's pictures at least, where the final one has as many."""
_MIN_PX = 4
"""Along a side: Blender renders no fewer."""
_REACH_PX = 2
"""Of a pixel's filter."""
_FAR_M = 0.6
"""Along the optical axis: where the floor is farther, its gloss comes from the light's picture of more pixels."""
_HEIGHTS = 16
"""Of such a picture, from the least to all of it."""
_PASSING = 1 / 15
"""Of the rows, over which one passes into the other."""
_LOW, _TIMES_LOW = 0.25, 2
"""Where it has no more of the rows, as many times the samples: what stands there is mostly lit from behind, and more of
them cost little."""
_WHOLLY, _MOSTLY = 0.99, 0.5
_CORNERS = (0, 2, -3, -1)
"""Of `filter_points`."""
_EVERY = 4
"""Of the rows of pixels, from the first: these tell nearly always which tiles all of them look up."""
_IN_M = 0.05
"""Where a picture's corners are that far inside the floor, so is all of it, unless a rolling shutter turns fast."""
_MAX_SHARE = 1.5
"""Of a still scene's light that may be left where something moves, or be thrown back by it."""
_MIN_SHARE = np.float32(0.005)
"""Of the picture's light: where there is no more of it, what is left of it is not told."""
_MIN_LIGHT = np.float32(1e-6)
_MAX_LEAN = 50.0
"""Of light that only grazes the floor, from 1 degree above it."""
_UP = (0.0, 0.0, 1.0)
_AROUND = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_ROUGHNESS = "roughness"
"""Of the floor, among what is seen of the surfaces."""


class HybridRenderer:
    """Of one job, whose scene stands in Blender, configured by `engine.configure`."""

    def __init__(self, job: RenderJob, threads: int, scratch: Path) -> None:
        if job.sampling.hybrid is None:
            raise ValueError("the job's pictures are not to be from hybrid rendering")
        self._samples, self._seed = job.sampling.hybrid, job.sampling.seed
        camera = pinhole_image(job.camera).camera
        self._size = camera.width_px, camera.height_px
        self._near, self._far = (_times(self._size, width_px) for width_px in (_NEAR_WIDTH_PX, _FAR_WIDTH_PX))
        self._scenes = HybridScenes(job.scene, scratch)
        self._denoised, self._denoised_fast = Denoiser(threads, "HIGH"), Denoiser(threads, "BALANCED")
        self._sight = FloorSight(camera, job.frames[0], window(job.shutter, job.camera).row_share)
        self._few, self._many = (filter_points(job.sampling.filter_width_px, squares) for squares in (1, 2))
        floor = [mesh for mesh in job.scene.meshes if lies_on_the_floor(mesh.name)]
        things = [mesh for mesh in job.scene.meshes if not lies_on_the_floor(mesh.name)]
        things += [_outline(panel) for panel in job.scene.panels if panel.seen]
        self._edges = EdgesInSight(camera, things, job.scene.moving, job.scene.robot_in_sight)
        ground = np.concatenate([np.array(mesh.vertices)[:, :2] for mesh in floor])
        self._bounds = ground.min(axis=0).astype(np.float32), ground.max(axis=0).astype(np.float32)
        surfaces = {name for mesh in floor for name in mesh.face_surface}
        self._has_relief = any(s.height_m is not None for s in job.scene.surfaces if s.name in surfaces)
        across_m, along_m = self._sight.pixel_m()
        self._slanted = along_m > _STEEP * across_m
        texel_m = _TEXEL_PX * np.maximum(across_m, along_m / _SLANT)
        finest_m = max(float(np.nanmin(texel_m, initial=_MAX_TEXEL_M)), _MIN_TEXEL_M)
        # Rounded, so that no processor's last digit moves all texels.
        reflectance = Tiling(float(f"{finest_m:.3g}"), _LEVELS, _CORE)
        self._reflectance_level = _level(texel_m, reflectance)
        self._floor_depth = self._sight.depth_m()
        self._irradiance_level = _level(np.maximum(self._floor_depth * _TEXEL_RAD, across_m), _IRRADIANCE)
        self._horizon_rows = _rows_of(~np.isfinite(self._floor_depth))
        self._far_floor_rows = _rows_of(~(self._floor_depth < _FAR_M))
        self._reflectance = TiledMap(reflectance, self._reflectance_tile, _MAX_BYTES, _with_upward_part)
        self._irradiance = TiledMap(_IRRADIANCE, self._irradiance_tile, _MAX_BYTES)
        self._relief = TiledMap(_RELIEF, self._relief_tile, _MAX_BYTES)

    def light(self, view: FrameView, seed: int) -> Image:
        """(H, W, 3) linear light of the pinhole picture of a view."""
        moved, still = self._scenes.light(self._shared_by(self._near), self._samples.near, seed, view)
        # Other random numbers than those of the light.
        seen = self._surfaces(view, moved[COVER][..., :1], (seed + 1) % 2**31)
        cover = seen[COVER][..., :1]
        floor, seen[_ROUGHNESS] = np.split(self._floor(view, cover[..., 0] > 0), [3], axis=-1)
        near = self._near_parts(moved, still, seen)
        share, traced = near[..., :3], near[..., 3:]
        end = self._far_end(cover)
        if end:
            far = self._far_parts(view, end, (seed + 2) % 2**31, seen)
            passing = (end - 0.5 - np.arange(len(far), dtype=np.float32)) / (_PASSING * self._size[1])
            traced[: len(far)] += np.clip(passing, 0, 1)[:, None, None] * (far - traced[: len(far)])
        light, rest, let_in = traced[..., :3], traced[..., 3:6], traced[..., 6:]
        on_floor = floor * cover * share * np.clip(let_in, 0, 1)
        return (on_floor + seen["DiffCol"] * light + np.maximum(rest, 0) + _shine(seen)).astype(np.float32)

    def _surfaces(self, view: FrameView, near_cover: Image, seed: int) -> Passes:
        """What the surfaces reflect, how far away they are, their normals, and where they are floor.

        Rows below all that is not floor, by its edges and by what the light's picture covers, are not traced.
        """
        covered = (_rows_of(near_cover[..., 0] < _WHOLLY) + 1) * self._near
        reached = max(covered, self._edges.lowest_row(view) + 1, self._horizon_rows) + _REACH_PX
        rows = min(max(reached, _MIN_PX), self._size[1])
        found = self._scenes.surfaces(self._size, rows, self._samples.surfaces, seed, view)
        floor = self._floor_depth[rows:, :, None]
        none = (0.0, 0.0, 0.0)
        below = {"DiffCol": none, "Emit": none, "Env": none, "Normal": _UP, COVER: (1.0, 1.0, 1.0)}
        filled = {name: np.broadcast_to(np.array(of, np.float32), (*floor.shape[:2], 3)) for name, of in below.items()}
        return {name: np.concatenate([found[name], of]) for name, of in (filled | {"Depth": floor}).items()}

    def _near_parts(self, moved: Passes, still: Passes, seen: Passes) -> Image:
        """(H, W, 10): the share of the still scene's light that is there, and what `_traced` has."""
        traced = self._traced(moved, seen, self._near)
        without = self._denoised(still["DiffDir"] + still["DiffInd"], reduced(seen["Normal"], self._near))
        least = _MIN_SHARE * np.median(without) + _MIN_LIGHT
        share = np.clip((traced[..., :3] + least) / (without + least), 0, _MAX_SHARE)
        return _brought(np.concatenate([share, traced], axis=-1), seen)

    def _far_parts(self, view: FrameView, end: float, seed: int, seen: Passes) -> Image:
        """(rows, W, 7) of what `_traced` has of the rows above an end."""
        height = self._size[1] // self._far
        # In steps: the denoiser keeps what it needs for each size that it has met.
        step = max(height // _HEIGHTS, _MIN_PX)
        rows = min(int(np.ceil(end / self._far / step)) * step, height) * self._far
        size, above = self._shared_by(self._far), {name: image[:rows] for name, image in seen.items()}
        samples = self._samples.far * (_TIMES_LOW if rows <= _LOW * self._size[1] else 1)
        upper = self._scenes.upper_light(size, rows // self._far, samples, seed, view)
        return _brought(self._traced(upper, above, self._far), above)

    def _traced(self, passes: Passes, seen: Passes, times: int) -> Image:
        """(h, w, 12) without noise: light, and what `_brought` needs of what else comes and of a share.

        The share is what the floor's coat lets through to what is below it, and back.
        """
        normal, roughness = (reduced(seen[name], times) for name in ("Normal", _ROUGHNESS))
        whole = (reduced(seen[COVER][..., :1], times) > _WHOLLY).astype(np.float32)
        light = passes["DiffDir"] + passes["DiffInd"]
        # A lamp in sight is told as finely as the surfaces; here it would be a firefly to the denoiser.
        rest = np.maximum(passes["Combined"] - passes["DiffCol"] * light - _shine(passes), 0)
        rest = self._denoised_fast(rest, normal, np.where(whole > 0, roughness, 1))
        let_in = passes["DiffCol"].mean(axis=-1, keepdims=True) / MIDDLE_GREY
        both = np.concatenate([rest, let_in], axis=-1)
        lines = np.where(whole > 0, local_lines(both, roughness, whole), np.concatenate([0 * both, both], axis=-1))
        return np.concatenate([self._denoised(light, normal), lines, roughness], axis=-1)

    def _far_end(self, cover: Image) -> float:
        """The row at which far floor and all other things end, and what they pass into; 0 where all is traced alike."""
        if self._near == self._far:
            return 0.0
        rows = max(self._far_floor_rows, _rows_of(cover[..., 0] < _MOSTLY))
        return rows + _PASSING * self._size[1] if rows else 0.0

    def _shared_by(self, times: int) -> tuple[int, int]:
        return self._size[0] // times, self._size[1] // times

    def _floor(self, view: FrameView, needed: np.ndarray) -> Image:
        """(H, W, 4): light that the floor throws back without what moves, and its roughness, where they are needed."""
        seen = np.zeros((*needed.shape, 7 if self._has_relief else 4), np.float32)
        for filtered, where in ((self._few, needed & ~self._slanted), (self._many, needed & self._slanted)):
            for level, rows, there in _bands(self._reflectance_level, where):
                points = [_turned(self._ground(view, point, rows), -GRID_TURN_RAD) for point in filtered]
                corners = [points[i][::_EVERY][there[::_EVERY]] for i in _CORNERS]
                found = self._mean(level, points, np.concatenate(corners))
                if np.isnan(found[..., 0][there]).any():
                    # Tiles that only others look up: at the end of the floor, at a tile's corner, between those rows.
                    found = self._mean(level, points, np.concatenate([own[there] for own in points]))
                np.copyto(seen[rows], found, where=there[..., None])
        light = seen[..., :3] * self._floor_light(view, needed, seen[..., 4:])
        return np.concatenate([light, seen[..., 3:4]], axis=-1)

    def _floor_light(self, view: FrameView, needed: np.ndarray, normal: Image) -> Image:
        points = self._ground(view, MIDDLE)
        found = self._looked_up(self._irradiance, points, needed, 3)
        if not self._has_relief:
            return found
        lean = self._looked_up(self._relief, points, needed, 6)
        facing = normal[..., 2:] + normal[..., :1] * lean[..., :3] + normal[..., 1:2] * lean[..., 3:]
        return found * np.maximum(facing, 0)

    def _looked_up(self, of: TiledMap, points: Image, needed: np.ndarray, channels: int) -> Image:
        """(H, W, channels) of a map of light at each pixel's point, between its levels."""
        found = np.zeros((*needed.shape, channels), np.float32)
        offset = np.log2(_IRRADIANCE.texel_m / of.tiling.texel_m)
        exact = np.clip(self._irradiance_level + offset, 0, of.tiling.levels - 1)
        for level, rows, there in _bands(np.floor(exact), needed):
            share = (exact[rows] - level)[..., None]
            looked_for = points[rows][there]
            near = of.patch(level, looked_for).at(points[rows])
            far = of.patch(min(level + 1, of.tiling.levels - 1), looked_for).at(points[rows])
            np.copyto(found[rows], near + share * (far - near), where=there[..., None])
        return found

    def _mean(self, level: int, points: list[np.ndarray], needed: np.ndarray) -> Image:
        """(H, W, K) of what the map has at points (H, W, 2) of each; NaN where some are not among the needed."""
        patch = self._reflectance.patch(level, needed)
        total = patch.at(points[0])
        for more in points[1:]:
            total += patch.at(more)
        return total / np.float32(len(points))

    def _ground(self, view: FrameView, point: FilterPoint, rows: slice = slice(None)) -> Image:
        """(rows, W, 2) points on the floor; those of pixels that see none are put where it ends."""
        low, high = self._bounds
        points = self._sight.points(view, point, rows)
        corners = points[[0, 0, -1, -1], [0, -1, 0, -1]]
        if not ((corners > low + _IN_M) & (corners < high - _IN_M)).all():
            np.fmin(np.fmax(points, low, out=points), high, out=points)
        return points

    def _reflectance_tile(self, tile: Tile) -> Image:
        """(N, N, 6): reflectance, roughness, and x and y of the normal; (N, N, 4) where nothing has a relief."""
        colour, told = self._scenes.reflectance(tile.widened())
        found = np.concatenate([colour, told[..., 2:]], axis=-1)[1:-1, 1:-1]
        if not self._has_relief:
            return found
        normal = normals(told[..., 0], told[..., 1], tile.texel_m)
        return np.concatenate([found, _turned(normal[..., :2], GRID_TURN_RAD)], axis=-1)

    def _irradiance_tile(self, tile: Tile) -> Image:
        light = self._light_on(tile, "irradiance", _UP)
        return self._evened_out(light, light)

    def _relief_tile(self, tile: Tile) -> Image:
        """(N, N, 6): what light on the floor grows by as its normal leans along x, and along y, per unit of the light.

        E(n) = E_z n_z + E_x n_x + E_y n_y for a little lean, of the vector irradiance. E_x is half of what a floor that
        is tilted one way gets more than one tilted the other way. Beside a level one either gets more than that sum
        says, for what would come from below its horizon counts as none, not as less than none.
        """
        cosine, sine = float(np.cos(_TILT_RAD)), float(np.sin(_TILT_RAD))
        tilts = (sine, 0.0, cosine), (-sine, 0.0, cosine), (0.0, sine, cosine), (0.0, -sine, cosine)
        level, *tilted = (self._light_on(tile, "relief", facing) for facing in (_UP, *tilts))
        up = np.maximum(self._evened_out(level, level), _MIN_LIGHT)
        east, west, north, south = (self._evened_out(light, level) / up for light in tilted)
        leans = [(east - west) / (2 * sine), (north - south) / (2 * sine)]
        return np.clip(np.concatenate(leans, axis=-1), -_MAX_LEAN, _MAX_LEAN)

    def _light_on(self, tile: Tile, what: str, facing: tuple[float, float, float]) -> Image:
        """With noise; by the same random numbers whichever way the floor faces."""
        level, i, j = (number % 2**32 for number in tile.key)
        seed = int(stream(self._seed, "path tracing", what, level, i, j).integers(2**31))
        return self._scenes.irradiance(tile, _IRRADIANCE_SAMPLES, seed, facing)

    def _evened_out(self, light: Image, level: Image) -> Image:
        """Without noise, and without holes, which the light on a level floor tells."""
        whole = without_holes(light, level)
        return self._denoised(whole, np.broadcast_to(np.array(_UP, np.float32), whole.shape))


def _times(size: tuple[int, int], width_px: int) -> int:
    """How many pixels of a picture, each way, share one of its light's, which is no narrower than that."""
    times = 1
    while size[0] // (2 * times) >= width_px and not any(px % (2 * times) or px < 2 * times * _MIN_PX for px in size):
        times *= 2
    return times


def _outline(panel: Panel) -> Mesh:
    along, across = 0.5 * panel.width_m * np.array(panel.right), 0.5 * panel.height_m * np.array(panel.up)
    corners = [tuple((panel.center + a * along + b * across).tolist()) for a, b in _AROUND]
    return rectangle(panel.name, corners, panel.name)


def _shine(passes: Passes) -> Image:
    """What lamps in sight send to the camera, and the sky where nothing is before it."""
    return passes["Emit"] + passes["Env"]


def _rows_of(where: np.ndarray) -> int:
    """Rows from the uppermost to the last of which something is there."""
    rows = np.flatnonzero(where.any(axis=1))
    return int(rows[-1]) + 1 if len(rows) else 0


def _brought(low: Image, seen: Passes) -> Image:
    """(H, W, K - 5) of (h, w, K), to the pixels of the surfaces' picture.

    The last nine channels are four slopes, four values, and the roughness of those; a floor's follow its own.
    """
    found = upsampled(low, 1 / np.maximum(seen["Depth"], 1e-3), seen["Normal"])
    alone, slope, value, roughness = np.split(found, [-9, -5, -1], axis=-1)
    rougher = np.where(seen[COVER][..., :1] > 0, seen[_ROUGHNESS] - roughness, 0)
    return np.concatenate([alone, value + slope * rougher], axis=-1)


def _with_upward_part(tile: Image) -> Image:
    """(N, N, 7) of (N, N, 6) as `_reflectance_tile` has them; z of the normal follows from x and y."""
    if tile.shape[-1] == 4:
        return tile
    upward = np.sqrt(np.maximum(1 - (tile[..., 4:] ** 2).sum(axis=-1, keepdims=True), 0))
    return np.concatenate([tile, upward], axis=-1)


def _turned(vectors: np.ndarray, by_rad: float) -> np.ndarray:
    """Vectors (..., 2) turned counter-clockwise."""
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.moveaxis(np.stack([cosine * x - sine * y, sine * x + cosine * y]), 0, -1)


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
