"""Marks that use leaves on tape and floor: where they lie and how much they change, as Cycles shows them."""

import math
from dataclasses import fields, replace

import cv2
import numpy as np
import pytest

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.line.tape import tape
from blender_scenes.materials.marks.stains import stained
from blender_scenes.scene.description import Scene, Sky, Sun
from blender_scenes.scene.meshes import rectangle
from blender_scenes.scene.run_scene import describe
from blender_scenes.scene.shading import Color, Expression, NoiseTexture, Surface
from configs.schema.appearance.floors import FloorLook
from configs.schema.appearance.look import LookConfig, TapeLook
from sensors.camera.colour import LUMINANCE
from sensors.camera.views import FrameView

PIXELS = 96
TAPES = {"bare": TapeLook(wear=0), "half": TapeLook(wear=0, streaks=0.5), "streaked": TapeLook(wear=0, streaks=1)}
TAPE_M = 0.1
PER_M = PIXELS / TAPE_M
"""Pixels."""
FLOOR_M = 1.5
PALE, DARK = 0.5, 0.3
"""Reflectances of even floors."""


def _surfaces() -> dict[str, tuple[Surface, float]]:
    """Surfaces with the size of the square of each that is looked at, from its corner at u = v = 0 on."""
    piece = SurfacePatch("tape", (9.0, 9.0), 1)
    made = {name: (tape(look, piece), TAPE_M) for name, look in TAPES.items()}
    for name, reflectance, amount in (("pale", PALE, 1.0), ("dark", DARK, 1.0), ("half stained", PALE, 0.5)):
        even = Surface("", Color((reflectance, reflectance, reflectance)))
        made[name] = stained(even, SurfacePatch("floor", (9.0, 9.0), 1), amount), FLOOR_M
    for name in ("bare", "streaked"):
        # Its roughness for all to see.
        made[f"roughness of {name}"] = Surface("", tape(TAPES[name], piece).roughness), TAPE_M
    return made


@pytest.fixture(scope="module")
def seen(light_of) -> dict[str, np.ndarray]:
    """(PIXELS, PIXELS) luminous reflectance without gloss and relief, u to the right."""
    surfaces, meshes, views, x = [], [], [], 0.0
    for name, (surface, size) in _surfaces().items():
        surfaces.append(replace(surface, name=name, roughness=1.0, height_m=None, refractive_index=1.0))
        corners = [(x, 0.0, 0.0), (x + size, 0.0, 0.0), (x + size, size, 0.0), (x, size, 0.0)]
        meshes.append(rectangle(f"m{len(meshes)}", corners, name))
        middle, above = 0.5 * size, 4.0 * size
        X_WC = ((1.0, 0.0, 0.0, x + middle), (0.0, -1.0, 0.0, middle), (0.0, 0.0, -1.0, above), (0.0, 0.0, 0.0, 1.0))
        views.append(FrameView(len(views) + 1, 0.0, (99.0, 99.0, 0.0), X_WC))
        x += size
    sun = Sun((0.0, 0.0, 1.0), (math.pi, math.pi, math.pi), 0.01)
    scene = Scene(tuple(surfaces), tuple(meshes), (), (), sun, Sky("studio", 0.0, 0.0, 10.0, 1.0))
    light = light_of(scene, views, PIXELS, 4.0 * PIXELS, samples=16)
    return {surface.name: image @ LUMINANCE for surface, image in zip(surfaces, light, strict=True)}


def test_streaks_make_tape_paler_and_darken_at_max_a_speck_of_dust(seen):
    added = seen["streaked"] - seen["bare"]
    assert np.quantile(added, 0.01) > -0.005
    assert np.quantile(added, 0.99) > 0.08


def test_where_streaks_are_palest_the_tape_is_smoothest(seen):
    added, rougher = seen["streaked"] - seen["bare"], seen["roughness of streaked"] - seen["roughness of bare"]
    assert np.corrcoef(added.ravel(), rougher.ravel())[0, 1] < -0.5
    assert rougher[added > 0.06].mean() < -0.02
    assert np.abs(rougher[added < 0.001]).mean() < 0.01


def test_half_of_the_streaks_add_half_of_the_light(seen):
    whole, half = ((seen[name] - seen["bare"]).mean() for name in ("streaked", "half"))
    assert half == pytest.approx(0.5 * whole, rel=0.1)


def test_streaks_lie_in_patches_and_leave_max_of_the_tape_black(seen):
    added = seen["streaked"] - seen["bare"]
    assert 0.02 < np.mean(added > 0.06) < 0.25
    blocks = added.reshape(4, PIXELS // 4, 4, PIXELS // 4).mean(axis=(1, 3))  # of 25 mm
    assert blocks.std() > 0.5 * blocks.mean()


def test_streaks_are_some_millimetres_long_and_narrow(seen):
    """By how alike the pattern is to itself, moved along the tape and across it; their patches taken off."""
    added = seen["streaked"] - seen["bare"]
    fine = added - cv2.GaussianBlur(added, (0, 0), PER_M * 0.005)

    def alike(along_m: float, across_m: float) -> float:
        u, v = round(along_m * PER_M), round(across_m * PER_M)
        return float(np.corrcoef(fine[v:, u:].ravel(), fine[: PIXELS - v, : PIXELS - u].ravel())[0, 1])

    assert alike(0.002, 0.0) > 0.5
    assert alike(0.0, 0.002) < 0.2
    assert abs(alike(0.02, 0.0)) < 0.2


def test_a_tape_without_streaks_has_none_of_their_textures():
    without, with_streaks = (
        _noises(tape(TapeLook(streaks=s), SurfacePatch("tape", (0.5, 0.02), 1))) for s in (0.0, 1e-6)
    )
    assert len(with_streaks - without) == 2
    assert without < with_streaks


@pytest.mark.parametrize(("name", "reflectance"), [("pale", PALE), ("dark", DARK)])
def test_stains_change_a_floor_by_about_a_tenth_and_keep_its_mean(seen, name, reflectance):
    assert seen[name].mean() == pytest.approx(reflectance, rel=0.06)
    assert 0.06 < seen[name].std() / reflectance < 0.14


def test_half_of_the_stains_are_half_of_the_spread(seen):
    assert seen["half stained"].std() == pytest.approx(0.5 * seen["pale"].std(), rel=0.15)


def test_stains_are_centimetres_to_decimetres_across(seen):
    """Of what differs, little is finer than 2 cm, and little coarser than half a metre."""
    relative, per_m = seen["pale"] / PALE - 1, PIXELS / FLOOR_M
    assert np.std(cv2.GaussianBlur(relative, (0, 0), 0.02 * per_m)) > 0.6 * relative.std()
    blocks = relative.reshape(3, PIXELS // 3, 3, PIXELS // 3).mean(axis=(1, 3))
    assert blocks.std() < 0.6 * relative.std()


def test_a_look_stains_its_floor_and_nothing_else(arena, robot):
    looks = (LookConfig(name="plain", floor=FloorLook(stains=amount)) for amount in (0.0, 0.4))
    even, stained_ = ({s.name: s for s in describe(arena, robot, look, seed=1).surfaces} for look in looks)
    assert {name for name in even if even[name] != stained_[name]} == {"floor"}


def test_a_floor_without_stains_is_the_surface_it_was():
    even = Surface("floor", Color((0.5, 0.5, 0.5)))
    assert stained(even, SurfacePatch("floor", (9.0, 9.0), 1), 0.0) is even


def _noises(surface: Surface) -> set[NoiseTexture]:
    found, left = set(), [surface.base_color, surface.roughness, surface.height_m]
    while left:
        part = left.pop()
        if isinstance(part, Expression):
            left += [getattr(part, field.name) for field in fields(part)]
            found |= {part} if isinstance(part, NoiseTexture) else set()
    return found
