"""Light of the sun and of small lamps on the floor where things that move shade it.

The border of such a shadow follows from the outlines of the things, pixel by pixel. The light of few pixels would blur
it, and the noise of one light among others would change the light inside.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blender_scenes.blender_side.hybrid.scenes import HybridScenes, Passes
from blender_scenes.hybrid.floor.sight import FilterPoint, FloorSight
from blender_scenes.hybrid.shadows.body_shadows import BodyShadows
from blender_scenes.hybrid.shadows.casters import casting_meshes
from blender_scenes.hybrid.shadows.small_lights import SmallLamp, SmallLight, SunDisc
from blender_scenes.hybrid.upsampling import reduced
from blender_scenes.scene.description import LightPanel, Scene
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage

_MIN_SHADED = 0.05
"""Share of the mean light on the floor below which a shadow in one light does not matter."""
_SAMPLES = 8
"""Rays to the light for each pixel of the light image, where windows and furniture may hide it in part."""
_MAX_SIZE = 0.15
"""Width of a lamp, as a share of its height above what moves, up to which its shadows have narrow borders."""
_MAX_LAMPS = 3
"""Number of lamps, the brightest ones, that are traced alone."""


@dataclass(frozen=True)
class ShadedLight:
    """A light that moving things hide from a part of the floor in sight."""

    light: SmallLight
    still: FloatImage
    """Its direct light (h, w, 3), without what moves."""
    visible: FloatImage
    """Share (H, W, 1) of it that moving things let through to the pixels of the image."""


@dataclass(frozen=True)
class HardLight:
    """The light on the floor, with and without what moves, divided into that of a few lights and the rest."""

    rest: tuple[FloatImage, FloatImage]
    """All light (h, w, 3) of the light image but that of `shaded`, with noise, with and without what moves."""
    shaded: tuple[ShadedLight, ...]


class HardLightTracer:
    """Tracer of the light of the sun and of small lamps in one scene, image by image."""

    def __init__(
        self,
        scene: Scene,
        scenes: HybridScenes,
        samples: int,
        sight: FloorSight,
        filters: Sequence[tuple[Sequence[FilterPoint], np.ndarray]],
    ) -> None:
        """Trace light images with so many samples; for `filters` see `BodyShadows.visible_share`."""
        self._scenes, self._samples, self._sight, self._filters = scenes, samples, sight, filters
        robot, moving = casting_meshes(scene)
        height_m = max((z for mesh in (*robot, *moving) for _, _, z in mesh.vertices), default=0.0)
        lights = [SunDisc(scene.sun)] if scene.sun else []
        lights += [SmallLamp(panel) for panel in _small_panels(scene.panels, height_m)]
        self._shadows = [(light, BodyShadows(light, robot, moving)) for light in lights if light.is_above(height_m)]

    def traced(
        self, view: FrameView, seed: int, lights: tuple[Passes, Passes], ground: FloatImage, spare_m: FloatImage
    ) -> HardLight | None:
        """Return the light of a view; None where nothing that moves shades the floor in sight from a small light.

        Args:
            view: View, whose light image was just traced.
            seed: Seed.
            lights: Light images with and without what moves.
            ground: Points (h, w, 2) of the floor in the middle of the light images' pixels.
            spare_m: Size (h, w) of a pixel there; NaN where there is no floor.
        """
        every = matt_light(lights[1]).mean(axis=-1)
        shaded = []
        for light, shadows in self._shadows:
            reached = shadows.may_reach(view, ground, spare_m)
            if reached.any():
                reached &= light.light_at(ground) > _MIN_SHADED * every[reached].mean()
            if reached.any() and (one := self._shaded(view, seed, (light, shadows), every, reached)):
                shaded.append(one)
        if not shaded:
            return None
        names = {one.light.name for one in shaded}
        lamps = self._scenes.lamplight(every.shape[::-1], self._samples, seed, view, names)
        with_, without = (light + passes["DiffInd"] for light, passes in zip(lamps, lights, strict=True))
        return HardLight((with_, without), tuple(shaded))

    def _shaded(
        self,
        view: FrameView,
        seed: int,
        one: tuple[SmallLight, BodyShadows],
        every: FloatImage,
        reached: np.ndarray,
    ) -> ShadedLight | None:
        """Return one of the lights if its shadow, where it may lie (h, w), matters beside all light (h, w)."""
        light, shadows = one
        still = self._scenes.direct_light(every.shape[::-1], _SAMPLES, seed, view, light.name)
        reached = reached & (still.mean(axis=-1) > _MIN_SHADED * every[reached].mean())
        if not reached.any():
            return None
        lines, shape = np.flatnonzero(reached.any(axis=1)), self._filters[0][1].shape
        times = shape[0] // len(reached)
        rows = slice(max(int(lines[0]) - 1, 0) * times, min(int(lines[-1]) + 2, len(reached)) * times)
        visible = np.ones((*shape, 1), np.float32)
        visible[rows, :, 0] = shadows.visible_share(view, self._sight, self._filters, rows)
        is_shaded = reached & (reduced(visible, times)[..., 0] < 1 - _MIN_SHADED)
        return ShadedLight(light, still, visible) if is_shaded.any() else None


def matt_light(passes: Passes) -> FloatImage:
    """Return the light (h, w, 3) on matt surfaces."""
    return passes["DiffDir"] + passes["DiffInd"]


def _small_panels(panels: Sequence[LightPanel], height_m: float) -> list[LightPanel]:
    """Return the brightest panels that shine downwards and are small beside their distance from a height."""
    small = [
        panel
        for panel in panels
        if np.cross(panel.right, panel.up)[2] < 0
        and max(panel.width_m, panel.height_m) < _MAX_SIZE * (panel.center[2] - height_m)
    ]
    return sorted(small, key=lambda panel: -sum(panel.radiance) * panel.width_m * panel.height_m)[:_MAX_LAMPS]
