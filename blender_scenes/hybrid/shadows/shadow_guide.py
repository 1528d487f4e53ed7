"""Light that robot and moving obstacles let through to the floor near them, predicted from their outlines.

The prediction takes all of each lamp for visible, and all other light for even. So it is only a guide to the borders of
shadows, which light of few pixels blurs; how dark they are follows from that light.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from blender_scenes.hybrid.floor.sight import MIDDLE, FloorSight
from blender_scenes.hybrid.shadows.body_shadows import moments_of
from blender_scenes.hybrid.shadows.casters import Caster, casters, casting_meshes
from blender_scenes.hybrid.shadows.shadow_mask import enclosing, point_masks, shadow_mask, share_past_all
from blender_scenes.hybrid.shadows.wide_lights import WideLamp, even_directions
from blender_scenes.scene.description import Scene
from sensors.camera.views import FrameView
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.poses import PlanarPose, pose_X_WR

_REACH, _MIN_REACH_M, _MAX_REACH_M = 2.0, 0.001, 0.15
"""Distance from a body up to which its shadow is predicted, in heights of the body, and its limits. Borders that are
farther away are those of high edges, and wide."""
_TEXEL_PX, _FINER, _MAX_TEXELS = 1.5, 2, 512
"""Size of a shadow's texel in pixels of the nearest floor, the number of pixels drawn along its side, and the maximum
number of texels along a side of the shadow."""
_EVEN_POINTS, _LAMP_POINTS, _MIN_POINTS = 48, 80, 8
"""Number of points of light from all sides, that of all lamps together, and the least one of a lamp."""
_MAX_SHAPES = 300
"""Number of shapes of a body, each drawn once for every point, beyond which its shadow is not predicted."""
_MIN_SHARE = np.float32(0.02)
"""Smallest prediction. In a deep shadow most of the light is what the prediction leaves out."""
_MIN_LIGHT = 1e-9


_Rectangle = tuple[Sequence[Caster], Array, Array, Array, float]
_Area = tuple[slice, slice]
"""Rows and columns of an image."""
_ALL = slice(None), slice(None)


class _Body:
    """The robot, or a moving obstacle, in its frame."""

    def __init__(self, shapes: Sequence[Caster]) -> None:
        self._shapes = shapes
        vertices = np.concatenate([shape.corners for shape in shapes])
        self.height_m = float(vertices[:, 2].max())
        self._low, self._high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
        self._reach_m = float(np.clip(_REACH * self.height_m, _MIN_REACH_M, _MAX_REACH_M))
        self.low, self.high = self._low - self._reach_m, self._high + self._reach_m

    def rectangle(self, points: Array, low: Array, high: Array, pixel_m: float) -> _Rectangle:
        """Return the arguments of `shadow_mask` for points (K, 4) of light in its frame, in a rectangle."""
        texel_m = max(_TEXEL_PX * pixel_m, float(np.max(high - low)) / _MAX_TEXELS)
        return self._shapes, points, low, high, texel_m

    def nearness(self, ground: FloatImage) -> FloatImage:
        """Return how much the shadow counts (H, W) at points (H, W, 2): 1 at the body, 0 beyond its reach."""
        beyond = (ground - np.clip(ground, self._low, self._high).astype(np.float32)) / np.float32(self._reach_m)
        return np.clip(2 - 2 * np.nan_to_num(np.hypot(*np.moveaxis(beyond, -1, 0)), nan=1.0), 0, 1).astype(np.float32)


@dataclass(frozen=True)
class _Seen:
    """A body near the floor in sight."""

    body: _Body
    X_WB: Array
    ground: FloatImage
    """Points (H, W, 2) of the floor in the frame of the body."""
    nearness: FloatImage

    def let_through(self, pixel_m: FloatImage, lights: Sequence[tuple[Array, Array]]) -> FloatImage:
        """Return the share (H, W, 3) of light that the body lets through.

        Args:
            pixel_m: Size (H, W) of a pixel on the floor.
            lights: For each light, its points (K, 4) in W and its part (3,) of all light.
        """
        masks = [shadow_mask(*self.rectangle(pixel_m, points, _ALL), finer=_FINER) for points, _ in lights]
        parts = [part.astype(np.float32) for _, part in lights]
        all_light = np.sum([part * mask.share[..., None] for part, mask in zip(parts, masks, strict=True)], axis=0)
        mask = replace(masks[0], share=all_light)
        return 1 - self.nearness[..., None] * (1 - mask.at(self.ground))

    def rectangle(self, pixel_m: FloatImage, points: Array, area: _Area) -> _Rectangle:
        """Return the arguments of `shadow_mask` for the floor in an area of the image that is near the body."""
        where = self.nearness[area] > 0
        ground, finest_m = self.ground[area][where], float(pixel_m[area][where].min())
        low = np.maximum(self.body.low, ground.min(axis=0) - finest_m)
        high = np.minimum(self.body.high, ground.max(axis=0) + finest_m)
        return self.body.rectangle(points @ np.linalg.inv(self.X_WB).T, low, high, finest_m)


def _past_all(
    seen: Sequence[_Seen], pixel_m: FloatImage, lights: Sequence[tuple[Array, Array]], area: _Area
) -> FloatImage:
    """Return the share (h, w, 3) of light that several bodies let through together in an area of the image."""
    near = [one for one in seen if (one.nearness[area] > 0).any()]
    grounds, strengths = [one.ground[area] for one in near], [one.nearness[area] for one in near]
    share = np.zeros((*grounds[0].shape[:-1], 3), np.float32)
    for points, part in lights:
        masks = [point_masks(*one.rectangle(pixel_m, points, area), finer=_FINER) for one in near]
        share += part.astype(np.float32) * share_past_all(len(points), masks, grounds, strengths)[..., None]
    return share


class ShadowGuide:
    """Prediction of the shadows of the robot and of moving obstacles on the floor of one scene, view by view."""

    def __init__(self, scene: Scene, sight: FloorSight) -> None:
        self._sight, self._panels, self._pixel_m = sight, scene.panels, sight.pixel_m()[0]
        robot, moving = casting_meshes(scene)
        by_body = (casters(meshes) for meshes in (robot, *([mesh] for mesh in moving)))
        self._bodies = [_Body(shapes) if 0 < len(shapes) <= _MAX_SHAPES else None for shapes in by_body]

    def share(self, view: FrameView, lights: tuple[FloatImage, FloatImage], off: Collection[str]) -> FloatImage:
        """Return the share (H, W, 3) of the light that what moves lets through, 1 far from it.

        Args:
            view: View.
            lights: Light (h, w, 3) on a matt floor without what moves: straight from lamps, and all other.
            off: Names of the lamps whose light is not in it.
        """
        share = np.ones((*self._pixel_m.shape, 3), np.float32)
        seen = self._seen(view)
        if not seen:
            return share
        near = np.any([one.nearness > 0 for one in seen], axis=0)
        lamps = self._lamps(view, near, max(one.body.height_m for one in seen), off)
        parts = _parts(lamps, *(_mean(light, near) for light in lights))
        # The numbers of points do not follow from the traced light, whose noise would move the steps of a border.
        brightness = np.array([lamp.light.sum() for lamp in lamps])
        counts = np.ceil(_LAMP_POINTS * brightness / brightness.sum()).astype(int).tolist()
        points = [lamp.points(max(count, _MIN_POINTS)) for lamp, count in zip(lamps, counts, strict=True)]
        even = even_directions(_EVEN_POINTS), 1 - sum(parts, np.zeros(3))
        all_lights = [*zip(points, parts, strict=True), even]
        for one in seen:
            share *= one.let_through(self._pixel_m, all_lights)
        near_several = np.sum([one.nearness > 0 for one in seen], axis=0) > 1
        if near_several.any():
            area = enclosing(near_several)
            together = _past_all(seen, self._pixel_m, all_lights, area)
            share[area] = np.where(near_several[area][..., None], together, share[area])
        return _MIN_SHARE + (1 - _MIN_SHARE) * share

    def _seen(self, view: FrameView) -> list[_Seen]:
        moments = moments_of(view)
        seen = []
        for number, body in enumerate(self._bodies):
            if body is None:
                continue
            poses: list[PlanarPose] = [(moment.robot_pose, *moment.moving)[number] for moment in moments]
            ground = self._sight.in_body(view, MIDDLE, poses)
            if (nearness := body.nearness(ground)).any():
                seen.append(_Seen(body, pose_X_WR(*poses[len(poses) // 2]), ground, nearness))
        return seen

    def _lamps(self, view: FrameView, near: np.ndarray, above_m: float, off: Collection[str]) -> list[WideLamp]:
        """Return the lamps that light, from above a height, the middle of the pixels (H, W) near what moves."""
        middle = np.append(self._sight.points(view, MIDDLE)[near].mean(axis=0), 0.0)
        lamps = [WideLamp(panel, middle, above_m) for panel in self._panels if panel.name not in off]
        return [lamp for lamp in lamps if lamp.light.any()]


def _mean(light: FloatImage, near: np.ndarray) -> Array:
    """Return the mean (3,) of light (h, w, 3) where pixels (H, W) are near what moves, as far as there are any."""
    times = len(near) // len(light)
    pixels = near[times // 2 :: times, times // 2 :: times]
    return light[pixels if pixels.any() else ...].reshape(-1, 3).mean(axis=0, dtype=float)


def _parts(lamps: Sequence[WideLamp], direct: Array, other: Array) -> list[Array]:
    """Return the part (3,) of the light that comes from each lamp.

    Where furniture hides lamps, the direct light is less than all of them would give; where it is more, some of it
    comes from sky or sun.
    """
    scale = np.minimum(1, direct / (sum((lamp.light for lamp in lamps), np.zeros(3)) + _MIN_LIGHT))
    return [lamp.light * scale / (direct + other + _MIN_LIGHT) for lamp in lamps]
