"""Hybrid rendering: light of few samples and surfaces of many samples, combined into an image.

Most of what the camera sees is the floor. Its reflectance, its relief, and the light on it without robot and moving
obstacles are the same in every image; they are rendered once, as maps (`floor_maps`). The light of an image is traced
with very few pixels and samples, twice with the same random numbers, with and without what moves. The ratio of the two,
which has no noise where nothing moves, is multiplied with the map's light; the borders of its shadows follow from the
outlines of what moves (`shadow_guide`). The upper rows, where the floor is far and where other things stand, are traced
again with more pixels; everything but the floor takes its light from there. The surfaces of these other things are
traced without bounces, which is fast, and only in the rows in which they are visible.
"""

from pathlib import Path

import numpy as np

from blender_scenes.blender_side.hybrid.floor_maps import FloorMaps, Hidden
from blender_scenes.blender_side.hybrid.guides import (
    ROUGHNESS,
    WHOLLY,
    is_floor,
    upsampled_light,
    weight_of_things,
    without_floor,
)
from blender_scenes.blender_side.hybrid.hard_light import HardLight, HardLightTracer, matt_light
from blender_scenes.blender_side.hybrid.materials import COVER, MIDDLE_GREY
from blender_scenes.blender_side.hybrid.scenes import HybridScenes, Passes, lies_on_the_floor
from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.hybrid.floor.sight import MIDDLE, FloorSight
from blender_scenes.hybrid.guided_filter import local_lines, no_brighter_than_around
from blender_scenes.hybrid.lowest_row import EdgesInSight
from blender_scenes.hybrid.shadows.moving_shade import denoised_pair
from blender_scenes.hybrid.shadows.shadow_guide import ShadowGuide
from blender_scenes.hybrid.upsampling import reduced
from blender_scenes.render.job import RenderJob
from blender_scenes.scene.description import LightPanel, Mesh
from blender_scenes.scene.meshes import rectangle
from sensors.camera.lens_warp import LIGHT_WIDTH_PX, pinhole_image
from sensors.camera.shutter import window
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage

_NEAR_WIDTH_PX, _FAR_WIDTH_PX = LIGHT_WIDTH_PX, 4 * LIGHT_WIDTH_PX
"""Minimum widths of the two light images, where the final image is that wide."""
_MIN_PX = 4
"""Minimum number of pixels along a side that Blender renders."""
_REACH_PX = 2
"""Radius of a pixel's filter."""
_FAR_M = 0.6
"""Depth beyond which the gloss of the floor comes from the light image of more pixels."""
_HEIGHTS = 16
"""Number of different heights of the upper light image."""
_BLENDED = 1 / 15
"""Share of the rows over which one light image blends into the other."""
_LOW, _TIMES_LOW = 0.25, 2
"""An upper light image of at most this share of the rows is small, so it has this many times the samples."""
_MOSTLY = 0.5
"""Share of the floor in a pixel below which something else covers most of it."""
_MAX_SHARE = 1.5
"""Maximum ratio of light with and without moving bodies; above 1 where a moving body reflects light."""
_MIN_SHARE = np.float32(0.005)
"""Share of the median light that is added to both sides of the ratio, which is undefined in the dark."""
_MIN_LIGHT = np.float32(1e-6)
_UP = (0.0, 0.0, 1.0)
_AROUND = ((-1, -1), (1, -1), (1, 1), (-1, 1))


class HybridRenderer:
    """Renderer of a job whose scene is in Blender, after `engine.configure`."""

    def __init__(self, job: RenderJob, threads: int, scratch: Path) -> None:
        if job.sampling.hybrid is None:
            raise ValueError("the job is not for hybrid rendering")
        self._samples = job.sampling.hybrid
        camera = pinhole_image(job.camera).camera
        self._size = camera.width_px, camera.height_px
        self._near, self._far = (_times(self._size, width_px) for width_px in (_NEAR_WIDTH_PX, _FAR_WIDTH_PX))
        self._scenes = HybridScenes(job.scene, scratch)
        self._denoised, self._denoised_fast = Denoiser(threads, "HIGH"), Denoiser(threads, "BALANCED")
        self._sight = FloorSight(camera, job.frames[0], window(job.shutter, job.camera).row_share)
        self._floor = FloorMaps(job, self._scenes, self._sight, self._denoised)
        objects = [mesh for mesh in job.scene.meshes if not lies_on_the_floor(mesh.name)]
        objects += [_outline(panel) for panel in job.scene.panels if panel.seen]
        self._edges = EdgesInSight(camera, objects, job.scene.moving, job.scene.robot_in_sight)
        self._light_pixel_m = self._near * self._per_light_pixel(self._sight.pixel_m()[1])
        self._hard_light = HardLightTracer(
            job.scene, self._scenes, self._samples.near, self._sight, self._floor.filters
        )
        self._shadow_guide = ShadowGuide(job.scene, self._sight)
        self._floor_depth = self._sight.depth_m()
        self._horizon_rows = _rows_of(~np.isfinite(self._floor_depth))
        self._far_floor_rows = _rows_of(~(self._floor_depth < _FAR_M))

    def light(self, view: FrameView, seed: int) -> FloatImage:
        """Return the linear light (H, W, 3) of the pinhole image of a view."""
        moved, still = self._scenes.light(self._shared_by(self._near), self._samples.near, seed, view)
        ground = self._per_light_pixel(self._floor.ground(view, MIDDLE))
        hard = self._hard_light.traced(view, (seed + 3) % 2**31, (moved, still), ground, self._light_pixel_m)
        # Other random numbers than the light has, or their errors would add up.
        seen = self._surfaces(view, moved[COVER][..., :1], (seed + 1) % 2**31)
        cover = seen[COVER][..., :1]
        needed = cover[..., 0] > 0
        reflectance, seen[ROUGHNESS], normal = np.split(self._floor.surface(view, needed), [3, 4], axis=-1)
        share, hidden, traced = self._near_light(view, moved, still, hard, seen)
        floor = reflectance * self._floor.light(view, needed, normal, hidden)
        end = self._far_end(cover)
        if end:
            far = self._far_light(view, end, (seed + 2) % 2**31, seen)
            # The finer light image blends into the coarse one over some rows, so that no border is visible.
            weight = (end - 0.5 - np.arange(len(far), dtype=np.float32)) / (_BLENDED * self._size[1])
            traced[: len(far)] += np.clip(weight, 0, 1)[:, None, None] * (far - traced[: len(far)])
        light, rest, let_in = traced[..., :3], traced[..., 3:6], traced[..., 6:]
        # On the floor: light of the maps, dimmed by what moves. Elsewhere: the reflectance times the traced light.
        on_floor = floor * cover * share * np.clip(let_in, 0, 1)
        return (on_floor + seen["DiffCol"] * light + np.maximum(rest, 0) + _shine(seen)).astype(np.float32)

    def _surfaces(self, view: FrameView, near_cover: FloatImage, seed: int) -> Passes:
        """Return reflectance, depth, normals and floor cover of the surfaces.

        Rows that show only floor, by the edges of other things and by the cover of the light image, are not traced.
        """
        covered = (_rows_of(near_cover[..., 0] < WHOLLY) + 1) * self._near
        reached = max(covered, self._edges.lowest_row(view) + 1, self._horizon_rows) + _REACH_PX
        rows = min(max(reached, _MIN_PX), self._size[1])
        upper = self._scenes.surfaces(self._size, rows, self._samples.surfaces, seed, view)
        floor = self._floor_depth[rows:, :, None]
        none = (0.0, 0.0, 0.0)
        below = {"DiffCol": none, "Emit": none, "Env": none, "Normal": _UP, COVER: (1.0, 1.0, 1.0)}
        shape = *floor.shape[:2], 3
        lower = {name: np.broadcast_to(np.array(value, np.float32), shape) for name, value in below.items()}
        return {name: np.concatenate([upper[name], rest]) for name, rest in (lower | {"Depth": floor}).items()}

    def _near_light(
        self, view: FrameView, moved: Passes, still: Passes, hard: HardLight | None, seen: Passes
    ) -> tuple[FloatImage, list[Hidden], FloatImage]:
        """Return the ratio (H, W, 3) of the light with and without what moves, and the channels of `_traced`.

        Between these are the parts of the light without what moves that what moves hides.
        """
        traced = self._traced(moved, seen, self._near)
        normal = reduced(seen["Normal"], self._near)
        with_and_without = hard.rest if hard else (matt_light(moved), matt_light(still))
        shaded = hard.shaded if hard else ()
        lights = with_and_without[1] - still["DiffInd"], still["DiffInd"]
        guide = self._shadow_guide.share(view, lights, {one.light.name for one in shaded})
        low_guide = reduced(guide, self._near)
        with_, without = denoised_pair(*with_and_without, normal, self._denoised, low_guide)
        # Pixels of the light image that show floor and a bright face would brighten the floor beside the face.
        floor_alone = is_floor(seen, self._near)
        # The borders of shadows are those of the guide, which has all pixels of the image.
        parts = with_ / low_guide, without, *(one.still for one in shaded)
        of_floor = [no_brighter_than_around(light, floor_alone) for light in parts]
        low = np.concatenate([*of_floor, traced], axis=-1)
        ends = 3 * (1 + np.arange(len(of_floor)))
        with_, without, *direct, traced = np.split(upsampled_light(low, seen), ends, axis=-1)
        # All renderings with and without what moves have the same random numbers, so their ratio is exactly 1 where
        # nothing that moves matters. The offset keeps it defined, and near the guide, where there is hardly any light.
        # It is a share of the light without that of `shaded`, which alone remains in a shadow.
        offset = _MIN_SHARE * np.median(of_floor[1]) + _MIN_LIGHT
        all_light = without + sum(direct) + offset
        remaining = [light * one.visible for light, one in zip(direct, shaded, strict=True)]
        share = np.clip(((with_ + offset) * guide + sum(remaining)) / all_light, 0, _MAX_SHARE)
        hidden = [
            ((light - left) / all_light, one.light) for light, left, one in zip(direct, remaining, shaded, strict=True)
        ]
        return share, hidden, traced

    def _far_light(self, view: FrameView, end: float, seed: int, seen: Passes) -> FloatImage:
        """Return (rows, W, 7), the channels of `_traced` for the rows above `end`."""
        height = self._size[1] // self._far
        # In steps, because the denoiser keeps buffers for each size.
        step = max(height // _HEIGHTS, _MIN_PX)
        rows = min(int(np.ceil(end / self._far / step)) * step, height) * self._far
        size, above = self._shared_by(self._far), {name: image[:rows] for name, image in seen.items()}
        samples = self._samples.far * (_TIMES_LOW if rows <= _LOW * self._size[1] else 1)
        upper = self._scenes.upper_light(size, rows // self._far, samples, seed, view)
        return upsampled_light(self._traced(upper, above, self._far), above)

    def _traced(self, passes: Passes, seen: Passes, times: int) -> FloatImage:
        """Return (h, w, 12) without noise, for `upsampled_light`: light on other things, gloss and transmission.

        Transmission is the share of light that passes the floor's coat to the base and back.
        """
        normal, roughness = (reduced(seen[name], times) for name in ("Normal", ROUGHNESS))
        cover, floor_alone = reduced(seen[COVER][..., :1], times), is_floor(seen, times)
        light = matt_light(passes)
        # A visible lamp is part of the surfaces; for the denoiser of the light it would be a firefly.
        rest = np.maximum(passes["Combined"] - passes["DiffCol"] * light - _shine(passes), 0)
        # Few paths find a small lamp, so few pixels are bright. A larger albedo would make matt joints too bright.
        rest = self._denoised_fast.keeping_mean(rest, normal, np.where(floor_alone > 0, 1 - roughness, 1))
        let_in = passes["DiffCol"].mean(axis=-1, keepdims=True) / MIDDLE_GREY
        both = np.concatenate([rest, let_in], axis=-1)
        flat = np.concatenate([0 * both, both], axis=-1)
        # Gloss follows the roughness of the floor, which the final image has at full resolution: lines over the
        # roughness carry it there. Other surfaces keep their values (slope 0). Where a pixel shows floor and other
        # things, its transmission is that of the floor around it: its own contains the colour of the other things.
        of_floor = np.concatenate([np.broadcast_to(floor_alone, rest.shape), cover > 0] * 2, axis=-1)
        lines = np.where(of_floor > 0, local_lines(both, roughness, floor_alone), flat)
        of_things = self._denoised.keeping_mean(light, normal, weight=weight_of_things(passes))
        of_things = without_floor(of_things, passes, cover)
        return np.concatenate([of_things, lines, roughness], axis=-1)

    def _far_end(self, cover: FloatImage) -> float:
        """Return the row where the upper light image ends, its blending included; 0 if it has no more pixels."""
        if self._near == self._far:
            return 0.0
        rows = max(self._far_floor_rows, _rows_of(cover[..., 0] < _MOSTLY))
        return rows + _BLENDED * self._size[1] if rows else 0.0

    def _per_light_pixel(self, image: FloatImage) -> FloatImage:
        """Return one value for each pixel of the light image of the whole view."""
        return image[self._near // 2 :: self._near, self._near // 2 :: self._near]

    def _shared_by(self, times: int) -> tuple[int, int]:
        return self._size[0] // times, self._size[1] // times


def _times(size: tuple[int, int], width_px: int) -> int:
    """Return how many pixels in each direction share one pixel of a light image at least `width_px` wide."""
    times = 1
    while size[0] // (2 * times) >= width_px and not any(px % (2 * times) or px < 2 * times * _MIN_PX for px in size):
        times *= 2
    return times


def _outline(panel: LightPanel) -> Mesh:
    along, across = 0.5 * panel.width_m * np.array(panel.right), 0.5 * panel.height_m * np.array(panel.up)
    corners = [tuple((panel.center + a * along + b * across).tolist()) for a, b in _AROUND]
    return rectangle(panel.name, corners, panel.name)


def _shine(passes: Passes) -> FloatImage:
    """Return the light of visible lamps and of the visible sky."""
    return passes["Emit"] + passes["Env"]


def _rows_of(where: np.ndarray) -> int:
    """Return the number of rows from the first row to the last one with a True."""
    rows = np.flatnonzero(where.any(axis=1))
    return int(rows[-1]) + 1 if len(rows) else 0
