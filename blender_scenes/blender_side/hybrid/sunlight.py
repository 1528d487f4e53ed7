"""Sunlight on the floor where things that move shade it: its border follows from their outlines, pixel by pixel.

The light of few pixels would blur the border of the shadow, and the noise of the sun among other lights would change
the light inside.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blender_scenes.blender_side.hybrid.scenes import HybridScenes, Passes
from blender_scenes.hybrid.floor_sight import FilterPoint, FloorSight
from blender_scenes.hybrid.sun_shadows import SunShadows
from blender_scenes.hybrid.upsampling import reduced
from blender_scenes.scene.description import Mesh, Scene
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage

_MIN_SHADED = 0.05
"""Share of the mean light on the floor below which a shadow in the sun does not matter."""
_SAMPLES = 8
"""Rays to the sun for each pixel of the light image, where windows and furniture may hide it in part."""


@dataclass(frozen=True)
class Sunlight:
    """The light on the floor, with and without what moves, divided into the direct light of the sun and the rest."""

    rest: tuple[FloatImage, FloatImage]
    """All light (h, w, 3) of the light image but that of the sun, with noise, with and without what moves."""
    still: FloatImage
    """Direct light (h, w, 3) of the sun, without what moves."""
    visible: FloatImage
    """Share (H, W, 1) of the sun's light that moving things let through to the pixels of the image."""


class SunlightTracer:
    def __init__(
        self,
        scene: Scene,
        scenes: HybridScenes,
        samples: int,
        sight: FloorSight,
        filters: Sequence[tuple[Sequence[FilterPoint], np.ndarray]],
    ) -> None:
        """Trace light images with so many samples; for `filters` see `SunShadows.visible_share`."""
        self._scenes, self._samples, self._sight, self._filters = scenes, samples, sight, filters
        clear = {surface.name for surface in scene.surfaces if surface.transmission}
        moving = [mesh if not clear & set(mesh.face_surface) else _without_faces(mesh) for mesh in scene.moving]
        self._shadows = SunShadows(scene.sun, scene.robot + scene.robot_in_sight, moving) if scene.sun else None

    def traced(
        self, view: FrameView, seed: int, lights: tuple[Passes, Passes], ground: FloatImage, spare_m: FloatImage
    ) -> Sunlight | None:
        """Return the light of a view; None where nothing that moves shades the floor in sight from the sun.

        Args:
            view: View, whose light image was just traced.
            seed: Seed.
            lights: Light images with and without what moves.
            ground: Points (h, w, 2) of the floor in the middle of the light images' pixels.
            spare_m: Size (h, w) of a pixel there; NaN where there is no floor.
        """
        if self._shadows is None:
            return None
        reached = self._shadows.may_reach(view, ground, spare_m)
        if not reached.any():
            return None
        size = reached.shape[::-1]
        sun = self._scenes.sunlight(size, _SAMPLES, seed, view)
        reached &= sun.mean(axis=-1) > _MIN_SHADED * matt_light(lights[1])[reached].mean()
        if not reached.any():
            return None
        lines, shape = np.flatnonzero(reached.any(axis=1)), self._filters[0][1].shape
        times = shape[0] // len(reached)
        rows = slice(max(int(lines[0]) - 1, 0) * times, min(int(lines[-1]) + 2, len(reached)) * times)
        visible = np.ones((*shape, 1), np.float32)
        visible[rows, :, 0] = self._shadows.visible_share(view, self._sight, self._filters, rows)
        if not (reached & (reduced(visible, times)[..., 0] < 1 - _MIN_SHADED)).any():
            return None
        lamps = self._scenes.lamplight(size, self._samples, seed, view)
        with_, without = (light + passes["DiffInd"] for light, passes in zip(lamps, lights, strict=True))
        return Sunlight((with_, without), sun, visible)


def matt_light(passes: Passes) -> FloatImage:
    """Return the light (h, w, 3) on matt surfaces."""
    return passes["DiffDir"] + passes["DiffInd"]


def _without_faces(mesh: Mesh) -> Mesh:
    """Return a mesh of glass, which throws hardly any shadow."""
    return Mesh(mesh.name, mesh.vertices, (), (), ())
