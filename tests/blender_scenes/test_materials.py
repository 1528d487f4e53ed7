"""Rules that every material must obey: pure, numbers only, physically possible."""

import math
import operator
from collections.abc import Iterator
from dataclasses import fields, replace
from functools import cache
from typing import get_args

import numpy as np
import pytest
from pydantic import TypeAdapter

from blender_scenes.lighting.panoramas import MEAN_COLOR
from blender_scenes.materials import FLOORS, SURFACES
from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.line.line_paint import line_paint
from blender_scenes.materials.line.tape import tape
from blender_scenes.materials.marks.dirt import dirtied
from blender_scenes.materials.marks.stains import stained
from blender_scenes.scene.description import Scene, Sky, Sun
from blender_scenes.scene.meshes import rectangle
from blender_scenes.scene.run_scene import describe
from blender_scenes.scene.shading import (
    Arithmetic,
    Cells,
    Color,
    Constant,
    Expression,
    ImageTexture,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Tiles,
    as_texture,
)
from blender_scenes.scene.typical import matt_color, typical_color
from configs.schema.appearance.asset import Asset, ImageLook
from configs.schema.appearance.floors import CeramicTile, FloorLook, FloorName, Vinyl
from configs.schema.appearance.lighting import PanoramaName
from configs.schema.appearance.look import LookConfig, TapeLook
from configs.schema.arena import ArenaConfig, LineConfig, SurfaceName, WallConfig
from physics.arena import surfaces
from sensors.camera.colour import LUMINANCE
from sensors.camera.views import FrameView
from symolo.arena.geometry import Arena

IMAGE = Asset(name="a.png", sha256="0" * 64, width_px=3, height_px=2, mean_rgb=(0.5, 0.4, 0.3))
LOOK = LookConfig(name="plain", floor=FloorLook(image=ImageLook(file=IMAGE, width_m=0.6)))
_SURFACE = TypeAdapter(Surface)


GLOSSY = LookConfig(name="glossy", tape=TapeLook(roughness=0.18, wear=1.0, wrinkles=1.0, streaks=1.0))
TERRAZZO = FloorLook(material="vinyl", vinyl=Vinyl(print="terrazzo"))
GROUT = FloorLook(material="ceramic_tile", ceramic_tile=CeramicTile(size_m=0.02, joint_width_m=0.03))
"""Tiles so small that only the joints between them are left."""
VARIANTS = {"terrazzo": TERRAZZO, "grout": GROUT}


def _floors(seed: int = 1) -> dict[str, Surface]:
    made = {name: make(LOOK.floor, SurfacePatch(name, (5.0, 5.0), seed)) for name, make in FLOORS.items()}
    return made | {
        name: FLOORS[look.material](look, SurfacePatch(name, (5.0, 5.0), seed)) for name, look in VARIANTS.items()
    }


def _worn(floor: Surface, patch: SurfacePatch) -> Surface:
    return dirtied(stained(floor, patch, 1.0), patch, 1.0)


def _made(seed: int = 1) -> dict[str, Surface]:
    made = _floors(seed)
    made |= {f"worn {name}": _worn(floor, SurfacePatch(name, (5.0, 5.0), seed)) for name, floor in made.items()}
    made |= {f"{name} body": make(LOOK, SurfacePatch(name, (0.08, 0.12), seed)) for name, make in SURFACES.items()}
    made["sawn plywood"] = SURFACES["plywood"](LOOK, SurfacePatch("sawn", (0.6, 0.02), seed))
    made["glossy tape"] = tape(GLOSSY.tape, SurfacePatch("glossy tape", (0.5, 0.015), seed), bend_per_m=-3.0)
    made["line paint"] = line_paint(LOOK.line_paint, SurfacePatch("line paint", (0.5, 0.015), seed))
    return made | {"tape": tape(LOOK.tape, SurfacePatch("tape", (0.5, 0.015), seed))}


_all = cache(_made)
EVERY, MADE_AGAIN = sorted(_all()), _made()


def test_every_floor_wall_and_sky_that_a_look_can_name_has_a_member():
    assert set(FLOORS) == set(get_args(FloorName)) == set(PAINTS) - set(VARIANTS) | {"image"}
    assert set(SURFACES) == set(get_args(SurfaceName)) == set(surfaces.SURFACES)
    assert set(MEAN_COLOR) == set(get_args(PanoramaName))


@pytest.mark.parametrize("name", EVERY)
def test_the_same_numbers_give_the_same_surface(name):
    assert _all()[name] == MADE_AGAIN[name]


@pytest.mark.parametrize("name", sorted({*EVERY} - {"image"}))  # which lies where the look says
def test_another_seed_gives_another_piece_of_the_same_colour(name):
    one, other = _all(1)[name], _all(2)[name]
    assert one != other
    assert typical_color(one) == pytest.approx(typical_color(other), abs=0.2)


@pytest.mark.parametrize("name", EVERY)
def test_a_surface_survives_its_json(name):
    surface = _all()[name]
    text = _SURFACE.dump_json(surface)
    assert _SURFACE.validate_json(text) == surface
    assert _SURFACE.dump_json(_SURFACE.validate_json(text)) == text


@pytest.mark.parametrize("name", EVERY)
def test_no_surface_returns_more_light_than_it_receives(name):
    """Whatever its textures come to, by interval arithmetic on their expressions."""
    surface = _all()[name]
    low, high = _range(surface.base_color)
    assert low <= high < 1
    assert low >= 0 if name.endswith("image") else low > 0  # an image may be as black as it likes
    low, high = _range(as_texture(surface.roughness))
    assert 0 <= low <= high <= 1 + 1e-9


def _parts(texture: Expression) -> Iterator[Expression]:
    yield texture
    for field in fields(texture):
        part = getattr(texture, field.name)
        if isinstance(part, Expression):
            yield from _parts(part)


def _range(texture: Expression) -> tuple[float, float]:
    """Bounds of a texture's components; what is equal in two of its parts is taken to vary on its own."""
    match texture:
        case Constant(value):
            return value, value
        case Color(rgb):
            return min(rgb), max(rgb)
        case NoiseTexture() | Cells() | Tiles() | ImageTexture():
            return 0.0, 1.0
        case SurfaceCoordinate():
            return 0.0, 10.0
        case Step(of, low, high):
            shares = [min(max((x - low) / (high - low), 0.0), 1.0) for x in _range(of)]
            return shares[0] ** 2 * (3 - 2 * shares[0]), shares[1] ** 2 * (3 - 2 * shares[1])
        case Mix(Constant(share), a, b):
            return tuple((1 - share) * x + share * y for x, y in zip(_range(a), _range(b), strict=True))
        case Mix(_, a, b):
            ends = (*_range(a), *_range(b))
            return min(ends), max(ends)
        case Arithmetic("sine"):
            return -1.0, 1.0
        case Arithmetic(operation, a, b):
            results = [_OPERATIONS[operation](x, y) for x in _range(a) for y in _range(b)]
            return min(results), max(results)
    raise TypeError(type(texture))


_OPERATIONS = {"add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "maximum": max}


@pytest.mark.parametrize("name", EVERY)
def test_no_surface_has_more_noises_than_a_renderer_can_afford(name):
    surface = _all()[name]
    wanted = [surface.base_color, surface.roughness, surface.height_m]
    found = {e for texture in wanted if isinstance(texture, Expression) for e in _parts(texture)}
    # What the richest floor has of its own, and dirt and stains upon it.
    assert sum(isinstance(e, NoiseTexture) for e in found) <= 13


PAINTS = {
    "linoleum": LOOK.floor.linoleum.paint,
    "ceramic_tile": LOOK.floor.ceramic_tile.paint,
    "parquet": LOOK.floor.parquet.paint,
    "concrete": LOOK.floor.concrete.paint,
    "carpet": LOOK.floor.carpet.paint,
    "plywood": LOOK.floor.plywood.paint,
    "paper_sheets": LOOK.floor.paper_sheets.paint,
    "vinyl": LOOK.floor.vinyl.paint,
    "terrazzo": TERRAZZO.vinyl.paint,
    "grout": GROUT.ceramic_tile.joint,
}


@pytest.fixture(scope="module")
def floor_light(light_of) -> dict[str, float]:
    """Mean luminous reflectance of four square metres of each floor without gloss and relief, the sun in the zenith."""
    surfaces, meshes, views = [], [], []
    for i, floor in enumerate(floor for name, floor in _floors().items() if name in PAINTS):
        surfaces.append(replace(floor, roughness=1.0, height_m=None, refractive_index=1.0))
        corners = [(2.0 * i + x, y, 0.0) for x, y in ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))]
        meshes.append(rectangle(f"m{i}", corners, floor.name))
        X_WC = ((1.0, 0.0, 0.0, 2.0 * i + 1.0), (0.0, -1.0, 0.0, 1.0), (0.0, 0.0, -1.0, 4.0), (0.0, 0.0, 0.0, 1.0))
        views.append(FrameView(i + 1, 0.0, (99.0, 99.0, 0.0), X_WC))
    sun = Sun((0.0, 0.0, 1.0), (math.pi, math.pi, math.pi), 0.01)
    scene = Scene(tuple(surfaces), tuple(meshes), (), (), sun, Sky("studio", 0.0, 0.0, 10.0, 1.0))
    light = light_of(scene, views, 16, 32.0)  # 16 pixels at 32 pixels a radian: 2 m from 4 m above
    return {s.name: float(seen.mean(axis=(0, 1)) @ LUMINANCE) for s, seen in zip(surfaces, light, strict=True)}


@pytest.mark.parametrize("name", PAINTS)
def test_a_floor_is_as_bright_as_its_paint(floor_light, name):
    """Joints, pores and the depth between loops take a little."""
    lost = 0.3 if name == "carpet" else 0.12
    assert (1 - lost) * PAINTS[name].reflectance <= floor_light[name] <= 1.08 * PAINTS[name].reflectance


def test_boards_are_as_bright_as_their_names():
    def luminance(name: SurfaceName) -> float:
        return float(np.array(typical_color(SURFACES[name](LOOK, SurfacePatch("wall", (1.0, 0.15), 1)))) @ LUMINANCE)

    boards: list[SurfaceName] = ["white_board", "light_grey_board", "dark_grey_board", "black_board"]
    assert luminance("white_board") > 0.7
    assert luminance("black_board") < 0.06
    assert np.all(np.diff([luminance(name) for name in boards]) < 0)


def test_the_tape_is_black_on_every_floor():
    dark = np.array(typical_color(_all()["tape"])) @ LUMINANCE
    for name in FLOORS:
        assert dark < 0.3 * float(np.array(typical_color(_all()[name])) @ LUMINANCE)


@pytest.mark.parametrize("surface", get_args(SurfaceName))
def test_every_face_of_a_scene_has_a_surface_of_its_own_name(robot, surface):
    wall = WallConfig(name="W", start=(0.0, 0.5), end=(1.0, 0.5), surface=surface)
    arena = Arena.from_config(ArenaConfig(name="one", line=LineConfig(), walls=(wall,)))
    scene = describe(arena, robot, LOOK, seed=1)
    names = [s.name for s in scene.surfaces]
    assert len(names) == len(set(names))
    used = {name for mesh in (*scene.meshes, *scene.robot) for name in mesh.face_surface}
    assert used <= set(names)
    assert all(len(m.face_surface) == len(m.faces) == len(m.uv_m) for m in (*scene.meshes, *scene.robot))


@pytest.mark.parametrize(
    ("texture", "expected"),
    [
        (Mix(Constant(0.25), Color((0.0, 0.4, 1.0)), Color((1.0, 0.4, 0.0))), (0.25, 0.4, 0.75)),
        (Mix(NoiseTexture((1.0, 1.0), (0.0, 0.0)), Constant(0.2), Color((0.6, 0.6, 0.6))), (0.4, 0.4, 0.4)),
        (Step(Constant(0.5), 0.0, 1.0) * 0.5 + 0.1, (0.35, 0.35, 0.35)),
        (Mix(Constant(0.5), Constant(0.0), ImageTexture("", (1.0, 1.0), (0.0, 0.0), (0.2, 0.4, 0.6))), (0.1, 0.2, 0.3)),
        (1 - Tiles((1.0, 1.0), 0.1, 0.0, (0.0, 0.0)) * 0.5, (1.0, 1.0, 1.0)),
    ],
)
def test_the_typical_colour_of_small_expressions_by_hand(texture, expected):
    assert typical_color(Surface("s", texture)) == pytest.approx(expected)


@pytest.mark.parametrize(("base", "expected"), [(0.0, 0.0502), (0.5, 0.5251), (1.0, 1.0)])
def test_the_matt_colour_has_the_gloss_of_light_at_45_degrees(base, expected):
    """Glass of index 1.5 reflects 9.20 % and 0.85 % of the two polarisations there (Hecht, Optics, section 4.6)."""
    glass = Surface("s", Color((base, base, base)), refractive_index=1.5)
    assert matt_color(glass, (base, base, base)) == pytest.approx((expected,) * 3, abs=1e-4)


@pytest.mark.parametrize("values", [{"refractive_index": 1.0}, {"metallic": 1.0}])
def test_the_matt_colour_of_a_surface_without_a_coat_is_its_base_colour(values):
    base = (0.3, 0.3, 0.3)
    assert matt_color(Surface("s", Color(base), **values), base) == base
