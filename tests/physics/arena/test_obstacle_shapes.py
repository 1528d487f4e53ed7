"""Obstacles with a shape, from a scenario to rays and contacts, against closed forms."""

import math

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_resolved, load_scenario, load_section
from configs.schema.obstacle_shapes.cone import Cone
from configs.schema.obstacle_shapes.cylinder import Cylinder
from configs.schema.scenario import RunSpec
from physics.arena.rays import RayScene
from pipeline.stages.simulate import simulate
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.dataset.documents.run_document import RunDocument

SCENARIO = """\
extends: smoke
stop: {lap: false, time_limit_s: 3}
arena:
  extends: symolo
  obstacles:
    - {name: can, center: [0.55, -0.55], surface: metal, shape: SHAPE}
"""
CAN = "{kind: cylinder, radius_m: 0.05, height_m: 0.2}"
FACET = 1.0 - math.cos(math.pi / 64)
"""Distance from the circle to the middle of one of 64 sides, relative to the radius."""


@pytest.fixture
def written(tmp_path):
    def write(shape=CAN, name="scenario.yaml", text=SCENARIO):
        path = tmp_path / name
        path.write_text(text.replace("SHAPE", shape))
        return str(path)

    return write


def _volume(body):
    return np.linalg.det(body.vertices[body.triangles]).sum() / 6.0


def _polygon_area(radius_m):
    return 0.5 * 64 * radius_m**2 * math.sin(2.0 * math.pi / 64)


def test_volumes_are_those_of_a_prism_and_of_a_frustum():
    can = Cylinder(kind="cylinder", radius_m=0.05, height_m=0.2).triangles()
    assert _volume(can) == pytest.approx(0.2 * _polygon_area(0.05))
    cut = Cone(kind="cone", bottom_radius_m=0.06, top_radius_m=0.02, height_m=0.3).triangles()
    below, above = _polygon_area(0.06), _polygon_area(0.02)
    assert _volume(cut) == pytest.approx(0.1 * (below + above + math.sqrt(below * above)))
    assert can.size == pytest.approx((0.1, 0.1, 0.2))


@pytest.mark.parametrize(
    ("shape", "height_m", "away_m", "radius_m"),
    [
        (CAN, 0.1, 0.25, 0.05),
        # A tip at 0.18 m: at two thirds of the height, a third of the radius of 0.06 m is left.
        ("{kind: cone, bottom_radius_m: 0.06, height_m: 0.18}", 0.12, 0.28, 0.02),
    ],
)
def test_a_beam_meets_it_at_its_radius(shape, height_m, away_m, radius_m, written):
    arena = Arena.from_config(draw_run(load_scenario(written(shape)), "CW", 1).arena)
    direction = np.linspace(0.0, 2.0 * math.pi, 50)
    ends = np.tile([0.55, -0.55, height_m], (50, 1))
    starts = ends + 0.3 * np.stack([np.cos(direction), np.sin(direction), np.zeros(50)], axis=1)
    hits = RayScene(arena).cast(starts, ends)
    assert set(hits.surface) == {len(arena.boxes)}
    np.testing.assert_allclose(0.3 * hits.fraction, away_m, atol=radius_m * FACET)


def test_the_robot_touches_it(written):
    loaded = load_scenario(written(), ["robot.controller.avoidance.front_below_m=0.001"])
    (problem,) = simulate(draw_run(loaded, "CW", 1)).problems
    assert problem.startswith("touched can at ")


def test_its_lengths_may_be_drawn_and_a_specification_has_its_triangles_alone(written):
    loaded = load_scenario(written("{kind: cylinder, radius_m: {uniform: [0.02, 0.05]}}"))
    specs = [draw_run(loaded, "CW", run) for run in (1, 2)]
    radii = [spec.drawn["arena.obstacles.0.shape.radius_m"] for spec in specs]
    assert radii[0] != radii[1]
    for spec, radius_m in zip(specs, radii, strict=True):
        assert spec.arena.obstacles[0].size == pytest.approx((2 * radius_m, 2 * radius_m, 0.12))
        text = spec.model_dump_json()
        assert '"shape"' not in text
        assert RunSpec.model_validate_json(text) == spec
    assert draw_run(load_resolved(loaded.tree, "metadata.json"), "CW", 1) == specs[0]
    read, drawn = (
        Arena.from_config(each).boxes[-1] for each in (RunDocument.model_validate(specs[0]).arena, specs[0].arena)
    )
    assert read.mesh is not None
    assert drawn.mesh is not None
    np.testing.assert_array_equal(read.mesh.vertices, drawn.mesh.vertices)


def test_it_grows_with_its_arena(written, tmp_path):
    arena = "extends: symolo\nobstacles:\n  - {name: can, center: [0.5, -0.5], shape: SHAPE}\n"
    written(name="arena.yaml", text=arena)
    (tmp_path / "double.yaml").write_text("extends: arena.yaml\nscale: 2\n")
    section = load_section("arena", str(tmp_path / "double.yaml"))
    shape = section.tree["obstacles"][0]["shape"]
    assert (shape["radius_m"], shape["height_m"]) == (0.1, 0.4)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ("{kind: sylinder}", "arena.obstacles.0.shape.kind: got 'sylinder', allowed: one of cone, cylinder"),
        ("{radius_m: 1}", "shape.kind"),
        ("{kind: cylinder, radius_m: -1}", "shape.radius_m: got -1, allowed: number >= 0.002 and <= 10"),
        ("{kind: cylinder, top_radius_m: 1}", "shape.top_radius_m"),
        ("{kind: cone}, mesh: {file: a.stl, packed: PACKED}", "shape: got 'cone', allowed: none beside mesh"),
    ],
)
def test_a_fault_names_its_place_and_what_is_allowed(shape, message, written):
    packed = Cylinder(kind="cylinder").triangles().packed()
    with pytest.raises(InputError) as fault:
        load_scenario(written(shape.replace("PACKED", packed)))
    assert message in str(fault.value)
    assert "scenario.yaml:6" in str(fault.value)
