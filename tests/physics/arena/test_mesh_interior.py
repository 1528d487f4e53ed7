"""Places inside bodies of triangles, against closed forms."""

import numpy as np
import trimesh

from physics.arena.mesh_interior import contains
from symolo.arena.mesh import TriangleMesh

PLACES = np.random.default_rng(2).uniform(-0.2, 0.2, (500, 3))


def mesh_of(body):
    return TriangleMesh(np.array(body.vertices), np.array(body.faces))


def test_places_in_a_box_and_in_a_ball_are_those_of_the_closed_forms():
    box = contains(mesh_of(trimesh.creation.box((0.3, 0.1, 0.2))), PLACES)
    np.testing.assert_array_equal(box, np.all(np.abs(PLACES) < (0.15, 0.05, 0.1), axis=1))
    ball = contains(mesh_of(trimesh.creation.icosphere(subdivisions=3, radius=0.1)), PLACES)
    distance_m = np.linalg.norm(PLACES, axis=1)
    is_clear = np.abs(distance_m - 0.1) > 0.002  # facets are inside of the sphere
    np.testing.assert_array_equal(ball[is_clear], (distance_m < 0.1)[is_clear])
    assert 10 < box.sum() < 400
    assert 10 < ball.sum() < 400


def test_bodies_that_overlap_and_one_with_a_hole_are_full_inside_and_a_wall_of_triangles_is_not():
    one, two = (trimesh.creation.box((0.2, 0.2, 0.2)) for _ in range(2))
    two.apply_translation((0.05, 0.0, 0.0))
    both = contains(mesh_of(trimesh.util.concatenate([one, two])), PLACES)
    x, y, z = PLACES.T
    np.testing.assert_array_equal(both, (x > -0.1) & (x < 0.15) & (np.abs(y) < 0.1) & (np.abs(z) < 0.1))
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    holed = TriangleMesh(np.array(ball.vertices), np.array(ball.faces)[3:])
    near = np.linalg.norm(PLACES, axis=1) < 0.05
    assert contains(holed, PLACES)[near].all()
    sheet = TriangleMesh(np.array([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    assert not contains(sheet, np.add(PLACES, (0.0, 0.0, 0.3))).any()


def test_no_places_are_none():
    assert len(contains(mesh_of(trimesh.creation.box((1, 1, 1))), np.zeros((0, 3)))) == 0
