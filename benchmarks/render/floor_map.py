"""The colour of the floor and of what lies flat on it, worked out once from above and looked up in every picture.

A camera sample pays for the floor's whole procedural texture; a texel of the map pays for it once in a run. A pixel
takes the mean of a few points within its filter, from the level of the map whose texels are as large as their distance.
"""

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import cv2
import numpy as np
from colour_exchange import Image
from mathutils import Matrix

from blender_scenes.description import FrameView, Intrinsics
from blender_scenes.job import RenderJob

LOOKED_UP = 4
"""Points of a pixel along each axis."""
FAR_TEXEL_M = 0.004
_REACH_M = 0.7
"""Beyond the places of the camera the fine part of the map ends."""
_TILE_PX = 2048
_HEIGHT_M = 0.5
_CYCLES_FILTER = 2.0
"""Cycles' Blackman-Harris filter reaches this many half widths from the pixel's middle (scene/film.cpp)."""

Trace = Callable[[bpy.types.Scene, int], Image]


def lies_on_the_floor(name: str) -> bool:
    """Whether a mesh belongs to the map, by its name in the scene's description."""
    return name == "floor" or name.startswith(("tape_", "paint_"))


@dataclass(frozen=True)
class _Level:
    low: np.ndarray
    texel_m: float
    texels: Image


class FloorMap:
    """Made by a scene that shows nothing but the floor, shining in its own colour."""

    def __init__(self, scene: bpy.types.Scene, trace: Trace, job: RenderJob, texel_m: float) -> None:
        self._scene, self._trace, self._camera = scene, trace, job.camera
        self._filter_width_px = job.sampling.filter_width_px
        scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.samples = "BOX", 1.0, 1
        data = bpy.data.cameras.new("above")
        data.type, data.clip_start = "ORTHO", 0.5 * _HEIGHT_M
        self._above = bpy.data.objects.new("above", data)
        scene.collection.objects.link(self._above)
        scene.camera = self._above
        places = np.array([view.X_WC for view in job.frames])[:, :2, 3]
        (whole,) = (np.array(mesh.vertices)[:, :2] for mesh in job.scene.meshes if mesh.name == "floor")
        fine = self._baked(places.min(axis=0) - _REACH_M, places.max(axis=0) + _REACH_M, texel_m)
        self._levels = [fine]
        while self._levels[-1].texel_m < FAR_TEXEL_M:
            last = self._levels[-1]
            smaller = cv2.resize(last.texels, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
            self._levels.append(_Level(last.low, 2 * last.texel_m, smaller))
        self._far = self._baked(whole.min(axis=0), whole.max(axis=0), FAR_TEXEL_M)

    def colour(self, view: FrameView) -> Image:
        """(H, W, 3) mean colour of the floor in each pixel's filter, as if nothing stood before it; 0 above it."""
        width, height = self._camera.width_px, self._camera.height_px
        apart_m = _distance_m(self._camera, view) / self._camera.fx_px / LOOKED_UP * 1.5
        wanted = np.floor(np.log2(np.maximum(apart_m / self._levels[0].texel_m, 1.0)))
        wanted = np.where(np.isfinite(wanted), np.minimum(wanted, len(self._levels) - 1), -1)
        offsets = filter_points(LOOKED_UP, self._filter_width_px)
        seen = np.zeros((height, width, 3), np.float32)
        for right in offsets:
            for down in offsets:
                points = floor_points(self._camera, view, right, down)
                for number in np.unique(wanted[wanted >= 0]).astype(int):
                    rows = np.flatnonzero((wanted == number).any(axis=1))
                    band = slice(rows[0], rows[-1] + 1)
                    there = (wanted[band] == number)[..., None]
                    seen[band] += np.where(there, self._looked_up(self._levels[number], points[band]), 0)
        return seen / LOOKED_UP**2

    def _looked_up(self, level: _Level, points: Image) -> Image:
        near, inside = _interpolated(level, points)
        if inside.all():
            return near
        return np.where(inside[..., None], near, _interpolated(self._far, points)[0])

    def _baked(self, low: np.ndarray, high: np.ndarray, texel_m: float) -> _Level:
        width, height = np.ceil((high - low) / texel_m).astype(int).tolist()
        texels = np.zeros((height, width, 3), np.float32)
        for y in range(0, height, _TILE_PX):
            for x in range(0, width, _TILE_PX):
                across, along = min(_TILE_PX, width - x), min(_TILE_PX, height - y)
                self._scene.render.resolution_x, self._scene.render.resolution_y = across, along
                self._above.data.ortho_scale = max(across, along) * texel_m
                middle = low + (np.array([x, y]) + 0.5 * np.array([across, along])) * texel_m
                self._above.matrix_world = Matrix.Translation((*middle.tolist(), _HEIGHT_M))
                texels[y : y + along, x : x + across] = self._trace(self._scene, x + y * width)[::-1]
        return _Level(low, texel_m, texels)


def _interpolated(level: _Level, points: Image) -> tuple[Image, np.ndarray]:
    """Colours (H, W, 3) at points (H, W, 2), and which of them lie on the map."""
    at = ((points - level.low) / level.texel_m - 0.5).astype(np.float32)
    height, width, _ = level.texels.shape
    inside = np.isfinite(at).all(axis=-1) & (at >= 0).all(axis=-1) & (at <= (width - 1, height - 1)).all(axis=-1)
    at = np.where(np.isfinite(at), at, 0.0).astype(np.float32)
    found = cv2.remap(level.texels, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return found, inside


def filter_points(count: int, width_px: float) -> np.ndarray:
    """Offsets from a pixel's middle [px], each for an equal share of Cycles' Blackman-Harris filter."""
    reach = 0.5 * _CYCLES_FILTER * width_px
    at = np.linspace(-reach, reach, 4001)
    turn = np.pi * (at / reach + 1)
    weight = 0.35875 - 0.48829 * np.cos(turn) + 0.14128 * np.cos(2 * turn) - 0.01168 * np.cos(3 * turn)
    share = np.cumsum(weight) / weight.sum()
    return np.interp((np.arange(count) + 0.5) / count, share, at)


def floor_points(camera: Intrinsics, view: FrameView, right_px: float, down_px: float) -> Image:
    """(H, W, 2) x and y in W [m] of the floor behind each pixel, moved by an offset; NaN above the horizon."""
    X_WC = np.array(view.X_WC)
    rays = _rays(camera, right_px, down_px) @ X_WC[:3, :3].T
    down = np.where(rays[..., 2] < -1e-6, rays[..., 2], np.nan)
    return X_WC[:2, 3] - (X_WC[2, 3] / down)[..., None] * rays[..., :2]


def _distance_m(camera: Intrinsics, view: FrameView) -> np.ndarray:
    """(H, W) of the floor behind each pixel along the optical axis; NaN above the horizon."""
    X_WC = np.array(view.X_WC)
    down = (_rays(camera, 0.0, 0.0) @ X_WC[:3, :3].T)[..., 2]
    return -X_WC[2, 3] / np.where(down < -1e-6, down, np.nan)


def _rays(camera: Intrinsics, right_px: float, down_px: float) -> np.ndarray:
    v, u = np.indices((camera.height_px, camera.width_px), dtype=np.float64)
    x, y = (u + right_px - camera.cx_px) / camera.fx_px, (v + down_px - camera.cy_px) / camera.fy_px
    return np.stack([x, y, np.ones_like(x)], axis=-1)
