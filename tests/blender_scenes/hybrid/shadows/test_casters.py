"""Shapes that are drawn for shadows: a convex body has the outline of its corners, other meshes that of their faces."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.hybrid.shadows.casters import Caster, casters, casting_meshes
from blender_scenes.hybrid.shadows.shadow_mask import shadow_mask
from blender_scenes.hybrid.shadows.wide_lights import even_directions
from blender_scenes.scene.description import Mesh, Scene, Sky
from blender_scenes.scene.meshes import block
from blender_scenes.scene.shading import Color, Surface

BOX = block("box", (0.0, 0.0, 0.03), (0.04, 0.02, 0.06), "red")
OPEN = replace(BOX, faces=BOX.faces[1:], face_surface=BOX.face_surface[1:])
LOW, HIGH = np.array([-0.2, -0.2]), np.array([0.2, 0.2])


def _of_faces(mesh: Mesh) -> list[Caster]:
    return [Caster(np.array([mesh.vertices[corner] for corner in face]), is_body=False) for face in mesh.faces]


def test_a_convex_body_is_drawn_as_a_whole_with_the_shadow_of_its_faces():
    (body,) = casters([BOX])
    assert body.is_body
    lights = even_directions(20)
    whole, faces = (shadow_mask(shapes, lights, LOW, HIGH, 0.002).share for shapes in ([body], _of_faces(BOX)))
    assert whole == pytest.approx(faces, abs=0.02)
    assert whole.min() < 0.1


CORNERS = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.02), (0.02, 0.02), (0.02, 0.04), (0.0, 0.04))
"""Outline of an angle, counter-clockwise."""
SIDES = tuple((i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6) for i in range(6))
ANGLE = Mesh(
    "angle",
    tuple((x, y, z) for z in (0.0, 0.05) for x, y in CORNERS),
    (tuple(range(5, -1, -1)), tuple(range(6, 12)), *SIDES),
    ("red",) * 8,
    (),
)


@pytest.mark.parametrize("mesh", [OPEN, ANGLE], ids=["open", "angle"])
def test_a_mesh_that_is_open_or_has_a_notch_is_drawn_face_by_face(mesh):
    shapes = casters([mesh])
    assert len(shapes) == len(mesh.faces)
    assert not any(shape.is_body for shape in shapes)


def test_moving_bodies_of_glass_throw_no_shadow():
    glass = Surface("glass", Color((1.0,) * 3), roughness=0.0, refractive_index=1.5, transmission=1.0)
    red = Surface("red", Color((0.5, 0.1, 0.1)), roughness=1.0, refractive_index=1.0)
    clear = replace(BOX, face_surface=("glass",) * len(BOX.faces))
    sky = Sky("studio", 0.0, 0.0, 10.0, 1.0)
    scene = Scene((glass, red), (), (BOX,), (), None, sky, moving=(clear, OPEN), robot_in_sight=(OPEN,))
    robot, moving = casting_meshes(scene)
    assert robot == (BOX, OPEN)
    assert [len(mesh.faces) for mesh in moving] == [0, len(OPEN.faces)]
