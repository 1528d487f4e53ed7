"""Sunlight on the floor with as many pixels as the final image, where things that move shade it.

The light of few pixels would blur the border of the shadow, and the noise of the sun among other lights would change
the light inside.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from blender_scenes.blender_side.hybrid.scenes import HybridScenes, Passes
from blender_scenes.blender_side.rendering import Part
from blender_scenes.hybrid.sun_shadows import SunShadows, visible_share
from blender_scenes.hybrid.upsampling import reduced
from blender_scenes.render.sampling import HybridSamples
from blender_scenes.scene.description import Scene
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage

_MIN_SHADED = 0.05
"""Share of the mean light on the floor below which a shadow in the sun does not matter."""
_MIN_PX = 4
"""Minimum number of pixels along a side that Blender renders."""


@dataclass(frozen=True)
class Sunlight:
    """The light on the floor, with and without what moves, divided into the direct light of the sun and the rest."""

    rest: tuple[FloatImage, FloatImage]
    """All light (h, w, 3) of the light image but that of the sun, with noise, with and without what moves."""
    where: tuple[slice, slice]
    """Rows and columns of the part of the light image in which moving things may shade the floor from the sun."""
    still: FloatImage
    """Direct light (rows, columns, 3) of the sun in that part, without what moves."""
    visible: FloatImage
    """Share (H, W, 1) of the sun's light that moving things let through to the pixels of the image."""


class SunlightTracer:
    def __init__(
        self, scene: Scene, scenes: HybridScenes, samples: HybridSamples, size: tuple[int, int], times: int
    ) -> None:
        """Trace for images of a size, whose light images have one pixel for `times` x `times` of theirs."""
        self._scenes, self._samples, self._size, self._times = scenes, samples, size, times
        self._shadows = SunShadows(scene.sun, scene.robot + scene.robot_in_sight, scene.moving) if scene.sun else None

    def traced(
        self, view: FrameView, seed: int, lights: tuple[Passes, Passes], ground: FloatImage, spare_m: FloatImage
    ) -> Sunlight | None:
        """Return the light of a view; None where nothing that moves shades the floor in sight from the sun.

        Args:
            view: View, whose light image was just traced.
            seed: Seed.
            lights: Light images with and without what moves.
            ground: Points (H, W, 2) of the floor in the middle of the light images' pixels.
            spare_m: Size (H, W) of a pixel there; NaN where there is no floor.
        """
        if self._shadows is None:
            return None
        reached = self._shadows.may_reach(view, ground, spare_m)
        small, direct = reached.shape[::-1], self._scenes.direct_light
        if not reached.any():
            return None
        # A single ray for each pixel of the light image says where the sun is hidden.
        shaded_sun, sun = direct(small, 1, seed, view, sun=True)
        shaded = reached & ((sun - shaded_sun).mean(axis=-1) > _MIN_SHADED * _matt_light(lights[1])[reached].mean())
        if not shaded.any():
            return None
        near = cv2.dilate(shaded.astype(np.uint8), np.ones((3, 3), np.uint8))
        rows, columns = (_span(near.any(axis=axis)) for axis in (1, 0))
        # Half of the rays of the surfaces: sunlight needs them at the borders of shadows only.
        samples, part = -(-self._samples.surfaces // 2), _part(rows, columns, self._times)
        shaded_sun, sun = direct(self._size, samples, seed, view, sun=True, part=part)
        visible = np.ones((*self._size[::-1], 1), np.float32)
        left, top = part.left_px, part.top_px
        visible[top : top + part.height_px, left : left + part.width_px] = visible_share(shaded_sun, sun)
        lamps = direct(small, self._samples.near, seed, view, sun=False)
        with_, without = (light + passes["DiffInd"] for light, passes in zip(lamps, lights, strict=True))
        return Sunlight((with_, without), (rows, columns), reduced(sun, self._times), visible)


def _matt_light(passes: Passes) -> FloatImage:
    return passes["DiffDir"] + passes["DiffInd"]


def _span(reached: np.ndarray) -> slice:
    """Return the range of the light pixels that are reached, at least as many as Blender renders."""
    at = np.flatnonzero(reached)
    first = max(min(int(at[0]), len(reached) - _MIN_PX), 0)
    return slice(first, max(int(at[-1]) + 1, first + _MIN_PX))


def _part(rows: slice, columns: slice, times: int) -> Part:
    """Return the part of the final image that some pixels of the light image cover."""
    width, height = columns.stop - columns.start, rows.stop - rows.start
    return Part(columns.start * times, rows.start * times, width * times, height * times)
