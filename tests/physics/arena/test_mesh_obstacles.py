"""Obstacles of triangles: what sensors see of them and what touches them, against closed forms and against PyBullet."""

import numpy as np
import pytest
import trimesh

from blender_scenes.scene.run_scene import describe
from configs.draw import draw_run
from configs.loader import load_resolved, load_scenario
from configs.schema.scenario import RunSpec
from physics.arena.rays import RayScene
from physics.bullet.ray_oracle import EngineRays
from pipeline.stages.simulate import simulate
from symolo.arena.geometry import Arena, Box, Line
from symolo.arena.mesh import TriangleMesh
from symolo.dataset.documents.run_document import RunDocument

FLOORED = Line((), 0.015, 0.05)


def standing(body, name="body", center=(0.6, 0.1), yaw=0.4, **options):
    """The obstacle of a trimesh body: its bounding box stands on the floor about `center`."""
    low, high = body.bounds
    vertices = np.array(body.vertices) - (*(0.5 * (low + high))[:2], low[2])
    mesh = TriangleMesh(vertices, np.array(body.faces))
    length, width, height = mesh.size
    return Box(name, "obstacle", (*center, 0.5 * height), (length, width, height), yaw, "wood", mesh=mesh, **options)


def arena_of(*boxes):
    return Arena("meshes", 4.0, 0.85, FLOORED, boxes)


def rays(count=2000, seed=4):
    rng = np.random.Generator(np.random.PCG64(seed))
    origins = rng.uniform((-0.6, -0.8, 0.02), (0.1, 1.0, 0.3), (count, 3))
    targets = rng.uniform((0.4, -0.1, 0.0), (0.8, 0.3, 0.25), (count, 3))
    return origins, origins + 1.6 * (targets - origins)


def test_the_triangles_of_a_box_are_met_as_the_box_is():
    body = trimesh.creation.box((0.3, 0.12, 0.2))
    meshed = standing(body)
    plain = Box("body", "obstacle", meshed.center, meshed.size, meshed.yaw_rad, "wood")
    ones, others = (RayScene(arena_of(box)).cast(*rays()) for box in (meshed, plain))
    assert (others.surface == 1).sum() > 300
    np.testing.assert_array_equal(ones.surface, others.surface)
    np.testing.assert_allclose(ones.fraction, others.fraction, atol=1e-9)
    np.testing.assert_allclose(ones.normal, others.normal, atol=1e-9)


def test_a_sphere_is_met_at_its_radius():
    ball = standing(trimesh.creation.icosphere(subdivisions=4, radius=0.1))
    directions = np.linspace(0.0, 2.0 * np.pi, 50)
    center = np.array(ball.center)
    origins = center + 0.5 * np.stack([np.cos(directions), np.sin(directions), np.zeros(50)], axis=1)
    hits = RayScene(arena_of(ball)).cast(origins, np.tile(center, (50, 1)))
    # 0.4 of 0.5 m; the facets of 5,120 triangles lie up to 0.1 % of the radius inside.
    np.testing.assert_allclose(hits.fraction, 0.8, atol=5e-4)
    np.testing.assert_allclose(np.einsum("nk,nk->n", hits.normal, (origins - center) / 0.5), 1.0, atol=5e-3)


def test_an_engine_meets_the_same_triangles():
    body = trimesh.util.concatenate(
        [trimesh.creation.box((0.3, 0.05, 0.2)), trimesh.creation.cylinder(0.06, 0.2, sections=24)]
    )
    arena = arena_of(standing(body))
    mine = RayScene(arena).cast(*rays())
    with EngineRays(arena) as engine:
        theirs = engine.cast(*rays())
    agree = mine.surface == theirs.surface
    # The engine rounds edges, so that a few rays that graze one differ.
    assert agree.mean() > 0.99
    both = agree & (mine.surface == 1)
    assert both.sum() > 200
    lengths_m = np.linalg.norm(rays()[1] - rays()[0], axis=1)
    np.testing.assert_allclose((mine.fraction * lengths_m)[both], (theirs.fraction * lengths_m)[both], atol=4e-3)


def test_a_ray_passes_between_the_legs_of_a_table():
    legs = [
        trimesh.creation.box((0.02, 0.02, 0.2), trimesh.transformations.translation_matrix((x, y, 0.1)))
        for x in (-0.1, 0.1)
        for y in (-0.1, 0.1)
    ]
    table = standing(trimesh.util.concatenate(legs), center=(0.5, 0.0), yaw=0.0)
    hits = RayScene(arena_of(table)).cast(
        np.array([[0.0, 0.0, 0.1], [0.0, 0.1, 0.1]]), np.array([[1.0, 0.0, 0.1], [1.0, 0.1, 0.1]])
    )
    assert hits.surface.tolist() == [-1, 1]
    assert hits.fraction[1] == pytest.approx(0.5 - 0.11)


SCENARIO = """\
extends: smoke
stop: {lap: false, time_limit_s: 3}
arena:
  extends: symolo
  assets: meshes
  obstacles:
    - {name: block, center: [0.55, -0.45], mesh: {file: block.stl, scale: 0.001}, surface: wood, SOLID}
"""


@pytest.fixture
def written(tmp_path):
    (tmp_path / "meshes").mkdir()
    # An L whose open corner the robot enters: 80 mm long legs of 30 mm.
    body = trimesh.util.concatenate(
        [
            trimesh.creation.box((110.0, 30.0, 100.0), trimesh.transformations.translation_matrix((0, -40, 50))),
            trimesh.creation.box((30.0, 110.0, 100.0), trimesh.transformations.translation_matrix((-40, 0, 50))),
        ]
    )
    body.export(tmp_path / "meshes/block.stl")

    def write(solid):
        path = tmp_path / "scenario.yaml"
        path.write_text(SCENARIO.replace("SOLID", f"solid: {str(solid).lower()}"))
        return path

    return write


def test_it_is_touched_where_it_is_solid_and_driven_through_where_it_is_not(written):
    ranges = {}
    for solid in (True, False):
        loaded = load_scenario(str(written(solid)), ["robot.controller.avoidance.front_below_m=0.001"])
        outcome = simulate(draw_run(loaded, "CW", 1))
        assert outcome.problems == (("touched block at 0.70 s",) if solid else ()) or solid, outcome.problems
        assert bool(outcome.problems) is solid
        ranges[solid] = outcome.recording["tof_m"].values[0, 0]
    assert ranges[True] < 0.25 < ranges[False]


def test_a_specification_and_a_release_need_no_other_file(written, tmp_path):
    loaded = load_scenario(str(written(solid=True)))
    spec = draw_run(loaded, "CW", 1)
    (obstacle,) = spec.arena.obstacles
    assert obstacle.size == pytest.approx((0.11, 0.11, 0.1), abs=1e-6)
    assert obstacle.mesh is not None
    assert (obstacle.mesh.file, len(obstacle.mesh.sha256)) == ("block.stl", 64)
    (tmp_path / "meshes/block.stl").unlink()
    again = RunSpec.model_validate_json(spec.model_dump_json())
    assert again == spec
    assert draw_run(load_resolved(loaded.tree, "metadata.json"), "CW", 1) == spec
    # A reader of the released spec.json has the same shape.
    boxes = [Arena.from_config(arena).boxes for arena in (spec.arena, RunDocument.model_validate(spec).arena)]
    np.testing.assert_array_equal(boxes[0][-1].mesh.vertices, boxes[1][-1].mesh.vertices)


def test_images_show_its_triangles_with_its_surface(written):
    spec = draw_run(load_scenario(str(written(solid=False))), "CW", 1)
    arena = Arena.from_config(spec.arena)
    scene = describe(arena, spec.robot, spec.look, 1)
    mesh = next(mesh for mesh in scene.meshes if mesh.name == "obstacle_block")
    assert len(mesh.faces) == 24
    vertices = np.array(mesh.vertices)
    assert vertices.min(axis=0) == pytest.approx((0.55 - 0.055, -0.45 - 0.055, 0.0), abs=1e-6)
    assert vertices.max(axis=0) == pytest.approx((0.55 + 0.055, -0.45 + 0.055, 0.1), abs=1e-6)
    assert set(mesh.face_surface) <= {surface.name for surface in scene.surfaces}


def test_shipped_arenas_have_no_key_of_a_mesh():
    text = draw_run(load_scenario("symolo"), "CW", 1).model_dump_json()
    assert '"mesh"' not in text
    assert '"solid"' not in text
