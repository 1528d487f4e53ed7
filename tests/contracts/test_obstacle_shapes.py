"""Rules for the body of every shape of an obstacle, with its defaults and at the ends of its settings."""

from typing import get_args

import numpy as np
import pytest
from pydantic import TypeAdapter

from configs.schema.obstacle_shapes import ObstacleShape
from symolo.arena.mesh import MAX_TRIANGLES, unpacked

SHAPES = get_args(get_args(ObstacleShape)[0])
KINDS = [shape.model_fields["kind"].annotation.__args__[0] for shape in SHAPES]


def _bodies(kind):
    """Yield bodies of the default, and with each setting at its ends."""
    shape = dict(zip(KINDS, SHAPES, strict=True))[kind]
    yield shape(kind=kind).triangles()
    for name, field in shape.model_fields.items():
        ends = [getattr(bound, side) for bound in field.metadata for side in ("ge", "le") if hasattr(bound, side)]
        yield from (shape(kind=kind, **{name: end}).triangles() for end in ends)


def test_there_is_a_shape_and_each_is_chosen_by_its_kind():
    assert len(set(KINDS)) == len(KINDS) > 1
    for kind, shape in zip(KINDS, SHAPES, strict=True):
        assert isinstance(TypeAdapter(ObstacleShape).validate_python({"kind": kind}), shape)


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_closed_and_its_faces_look_outwards(kind):
    for body in _bodies(kind):
        edges = [
            (a, b) for triangle in body.triangles.tolist() for a, b in zip(triangle, np.roll(triangle, -1), strict=True)
        ]
        assert len(set(edges)) == len(edges), "two faces at one side of an edge"
        assert {(b, a) for a, b in edges} == set(edges), "a hole"
        corners = body.vertices[body.triangles]
        assert np.linalg.det(corners).sum() / 6.0 > 0.0, "inside out"


@pytest.mark.parametrize("kind", KINDS)
def test_it_stands_on_the_floor_about_the_origin_and_fits_into_a_specification(kind):
    for body in _bodies(kind):
        low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
        assert low[2] == 0.0
        np.testing.assert_allclose(low[:2], -high[:2], atol=1e-12)
        assert min(body.size) > 0.0
        assert len(body.triangles) <= MAX_TRIANGLES
        np.testing.assert_allclose(unpacked(body.packed()).vertices, body.vertices, rtol=1e-7, atol=1e-9)
