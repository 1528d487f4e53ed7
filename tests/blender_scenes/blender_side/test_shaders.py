"""What Cycles makes of texture expressions, against the same expressions evaluated by hand or in Python."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from blender_scenes.scene.description import Mesh, Scene, Sky, Sun
from blender_scenes.scene.meshes import rectangle
from blender_scenes.scene.shading import (
    Arithmetic,
    Cells,
    Color,
    Constant,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Tiles,
)
from blender_scenes.scene.typical import typical_color
from sensors.camera.views import FrameView

A, B = Color((0.8, 0.1, 0.4)), Color((0.2, 0.5, 0.3))
CONSTANT = {
    "color": A,
    "mix": Mix(Constant(0.3), A, B),
    "mix beyond its ends": Mix(Constant(1.4), A, B),
    "add": Mix(Constant(0.3) + 0.2, A, B),
    "subtract": Mix(0.9 - Constant(0.2), A, B),
    "multiply": Mix(Constant(0.3) * 2.0, A, B),
    "maximum": Mix(Arithmetic("maximum", Constant(0.3), Constant(0.6)), A, B),
    "sine": Mix(Arithmetic("sine", Constant(math.pi / 6)), A, B),
    "step below": Mix(Step(Constant(0.1), 0.2, 0.6), A, B),
    "step within": Mix(Step(Constant(0.3), 0.2, 0.6), A, B),
}
_BLACK, _WHITE = Color((0.0, 0.0, 0.0)), Color((0.9, 0.9, 0.9))


def _grey(by) -> Mix:
    return Mix(by, _BLACK, _WHITE)


# Each is looked at in the middle of its own square of 0.2 m, at u = v = 0.1.
PLACED = {
    "coordinate": (_grey(SurfaceCoordinate("u") * 5.0), 0.45),
    "in a joint": (_grey(Tiles((0.1, 0.1), 0.02, 0.0, (0.0, 0.0))), 0.9),
    "on a tile": (_grey(Tiles((0.1, 0.1), 0.02, 0.0, (0.05, 0.05))), 0.0),
    "beside a joint of 18 mm": (_grey(Tiles((0.1, 0.1), 0.018, 0.0, (0.0105, 0.0105))), 0.0),
    # The joint ends 10 mm from its middle; half of that, the softness, is the part over which the value rises.
    "halfway up the soft edge of a joint": (_grey(Tiles((0.1, 0.1), 0.02, 0.0, (0.0075, 0.05), softness=0.5)), 0.45),
    "beyond the soft edge of a joint": (_grey(Tiles((0.1, 0.1), 0.02, 0.0, (0.0025, 0.05), softness=0.5)), 0.9),
    "in a course shifted by half": (_grey(Tiles((0.1, 0.1), 0.02, 0.5, (0.0, -0.05))), 0.0),
}


@pytest.fixture(scope="module")
def seen(light_of) -> dict[str, np.ndarray]:
    """Reflectance (3,) of each expression, by name."""
    textures = {**CONSTANT, **{name: texture for name, (texture, _) in PLACED.items()}}
    return dict(zip(textures, _reflectances(light_of, list(textures.values())), strict=True))


def _reflectances(light_of, textures: Sequence, pixels: int = 5, focal_px: float = 800.0) -> list[np.ndarray]:
    """Means over images of squares in a row, each seen from 0.5 m above its middle, in the sun from the zenith."""
    surfaces, meshes, views = [], [], []
    for i, texture in enumerate(textures):
        surfaces.append(Surface(f"s{i}", texture, roughness=1.0, refractive_index=1.0))
        meshes.append(_square(f"m{i}", 0.2 * i, surfaces[-1].name))
        X_WC = ((1.0, 0.0, 0.0, 0.2 * i + 0.1), (0.0, -1.0, 0.0, 0.1), (0.0, 0.0, -1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
        views.append(FrameView(i + 1, 0.0, (9.0, 9.0, 0.0), X_WC))
    sun = Sun((0.0, 0.0, 1.0), (math.pi, math.pi, math.pi), 0.01)
    scene = Scene(tuple(surfaces), tuple(meshes), (), (), sun, Sky("studio", 0.0, 0.0, 10.0, 1.0))
    return [light.mean(axis=(0, 1)) for light in light_of(scene, views, pixels, focal_px)]


def _square(name: str, x: float, surface: str) -> Mesh:
    return rectangle(name, [(x, 0.0, 0.0), (x + 0.2, 0.0, 0.0), (x + 0.2, 0.2, 0.0), (x, 0.2, 0.0)], surface)


@pytest.mark.parametrize("name", CONSTANT)
def test_cycles_and_python_agree_on_constant_expressions(seen, name):
    assert seen[name] == pytest.approx(typical_color(Surface("s", CONSTANT[name])), abs=0.01)


@pytest.mark.parametrize("name", PLACED)
def test_textures_lie_where_their_numbers_say(seen, name):
    assert seen[name] == pytest.approx(np.full(3, PLACED[name][1]), abs=0.015)


def test_random_patterns_have_the_mean_that_is_counted_with(light_of):
    patterns = [
        NoiseTexture((100.0, 100.0), (3.0, 5.0), octaves=3),
        Cells((60.0, 60.0), (1.0, 2.0), "random"),
        Cells((60.0, 60.0), (1.0, 2.0), "distance"),
        Tiles((0.012, 0.012), 0.0001, 0.0, (0.0, 0.0), "random"),
    ]
    reflectances = _reflectances(light_of, [_grey(pattern) for pattern in patterns], pixels=48, focal_px=120.0)
    for pattern, mean in zip(patterns, reflectances, strict=True):
        assert mean == pytest.approx(typical_color(Surface("s", _grey(pattern))), abs=0.09), pattern.kind
