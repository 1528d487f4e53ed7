"""Denoised images have the light of all samples, also of the bright pixels that the denoiser takes for noise."""

import numpy as np
import pytest

from blender_scenes.render.light_paths import LIGHT_PATHS
from blender_scenes.scene.description import LightPanel, Scene, Sky
from blender_scenes.scene.meshes import block, floor
from blender_scenes.scene.shading import Color, Surface
from sensors.camera.views import FrameView

PIXELS, FOCAL_PX, SAMPLES = 64, 512.0, 8
DOWN = ((1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
LAMP_M, LAMP_HEIGHT_M, MIRROR_HEIGHT_M = 0.6, 0.6, 1.0
LAMP = LightPanel("lamp", (0.0, 0.0, LAMP_HEIGHT_M), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), LAMP_M, LAMP_M, (4.0, 4.0, 4.0))
"""It shines up, to a mirror above, so only a few of the paths from the floor end at it."""
FLOOR = Surface("floor", Color((0.5, 0.5, 0.5)), roughness=1.0, refractive_index=1.0)
MIRROR = Surface("mirror", Color((0.9, 0.9, 0.9)), roughness=0.0, metallic=1.0)
MESHES = (
    floor("floor", (-0.1, -0.1), (0.1, 0.1), 0.0, "floor"),
    block("mirror", (0.0, 0.0, MIRROR_HEIGHT_M + 0.5), (8.0, 8.0, 1.0), "mirror"),
)
SCENE = Scene((FLOOR, MIRROR), MESHES, robot=(), panels=(LAMP,), sun=None, sky=Sky("studio", 0.0, 0.0, 10.0, 1.0))


@pytest.fixture(scope="module")
def denoised(light_of) -> np.ndarray:
    """Light (P, P) of the floor."""
    options = {"samples": SAMPLES, "paths": LIGHT_PATHS["complete"], "denoise": True}
    view = FrameView(1, 0.0, (50.0, 50.0, 0.0), DOWN)
    return light_of(SCENE, [view], PIXELS, FOCAL_PX, **options)[0, ..., 0]


def _share_of_a_square(half_side_m: float, distance_m: float) -> float:
    """Return the share of even light on a point that comes from a square above it (view factor, Howell B-3)."""
    a = half_side_m / distance_m
    root = (1 + a * a) ** 0.5
    return 4 / np.pi * (a / root) * np.arctan(a / root)


def test_a_floor_has_the_light_of_a_lamp_in_a_mirror_after_the_denoiser(denoised):
    """The lamp in the mirror is as far above the mirror as the lamp is below it.

    With the denoiser alone, the mean was 2.7 % too small.
    """
    share = _share_of_a_square(0.5 * LAMP_M, 2 * MIRROR_HEIGHT_M - LAMP_HEIGHT_M)
    assert denoised.mean() == pytest.approx(0.5 * 0.9 * 4.0 * share, rel=0.02)


def test_the_denoised_floor_has_no_bright_pixels(denoised):
    """A pixel of few samples has about 1.25 times its mean as noise."""
    assert denoised.std() < 0.05 * denoised.mean()
