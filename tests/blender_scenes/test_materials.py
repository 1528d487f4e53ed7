"""Held by every member of every family: pure, numbers only, physically possible."""

from typing import get_args

import numpy as np
import pytest
from pydantic import TypeAdapter

from blender_scenes.colour import LUMINANCE
from blender_scenes.lighting.panoramas import MEAN_COLOR
from blender_scenes.materials import FLOORS, SURFACES
from blender_scenes.materials.base import Patch
from blender_scenes.materials.tape import tape
from blender_scenes.scene import describe
from blender_scenes.shading import Color, Mix, Noise, Number, Step, Surface, Tiles
from blender_scenes.typical import typical_color
from configs.schema.arena import ArenaConfig, Line, SurfaceName, Wall
from configs.schema.lighting import PanoramaName
from configs.schema.look import FloorName, LookConfig
from physics import surfaces
from physics.arena import Arena

LOOK = LookConfig(name="plain")
_SURFACE = TypeAdapter(Surface)


def _all(seed: int = 1) -> dict[str, Surface]:
    made = {name: make(LOOK.floor, Patch(name, (5.0, 5.0), seed)) for name, make in FLOORS.items()}
    made |= {name: make(LOOK, Patch(name, (0.08, 0.12), seed)) for name, make in SURFACES.items()}
    return made | {"tape": tape(LOOK.tape, Patch("tape", (0.5, 0.015), seed))}


EVERY = sorted(_all())


def test_every_floor_wall_and_sky_that_a_look_can_name_has_a_member():
    assert set(FLOORS) == set(get_args(FloorName))
    assert set(SURFACES) == set(get_args(SurfaceName)) == set(surfaces.SURFACES)
    assert set(MEAN_COLOR) == set(get_args(PanoramaName))


@pytest.mark.parametrize("name", EVERY)
def test_the_same_numbers_give_the_same_surface(name):
    assert _all()[name] == _all()[name]


@pytest.mark.parametrize("name", EVERY)
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
    assert 0 < min(typical_color(_all()[name])) <= max(typical_color(_all()[name])) <= 0.95


def test_boards_are_as_bright_as_their_names():
    def luminance(name: SurfaceName) -> float:
        return float(np.array(typical_color(SURFACES[name](LOOK, Patch("wall", (1.0, 0.15), 1)))) @ LUMINANCE)

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
    wall = Wall(name="W", start=(0.0, 0.5), end=(1.0, 0.5), surface=surface)
    arena = Arena.from_config(ArenaConfig(name="one", line=Line(), walls=(wall,)))
    scene = describe(arena, robot, LOOK, seed=1)
    names = [s.name for s in scene.surfaces]
    assert len(names) == len(set(names))
    used = {name for mesh in (*scene.meshes, *scene.robot) for name in mesh.face_surface}
    assert used <= set(names)
    assert all(len(m.face_surface) == len(m.faces) == len(m.uv_m) for m in (*scene.meshes, *scene.robot))


@pytest.mark.parametrize(
    ("texture", "expected"),
    [
        (Mix(Number(0.25), Color((0.0, 0.4, 1.0)), Color((1.0, 0.4, 0.0))), (0.25, 0.4, 0.75)),
        (Mix(Noise((1.0, 1.0), (0.0, 0.0)), Number(0.2), Color((0.6, 0.6, 0.6))), (0.4, 0.4, 0.4)),
        (Step(Number(0.5), 0.0, 1.0) * 0.5 + 0.1, (0.35, 0.35, 0.35)),
        (1 - Tiles((1.0, 1.0), 0.1, 0.0, (0.0, 0.0)) * 0.5, (1.0, 1.0, 1.0)),
    ],
)
def test_the_typical_colour_of_small_expressions_by_hand(texture, expected):
    assert typical_color(Surface("s", texture)) == pytest.approx(expected)
