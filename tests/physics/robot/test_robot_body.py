"""A robot whose body is a mesh file: seen in images, and touching things with its convex hull."""

import numpy as np
import pytest
import trimesh

from blender_scenes.scene.robot_body import robot_body, robot_surfaces
from configs.draw import draw_robot, draw_run
from configs.loader import load_scenario, load_section
from configs.schema.robot import RobotConfig
from physics.bullet.simulation import BulletSimulation
from symolo.arena.geometry import Arena, Box, Line
from symolo.core.errors import InputError


@pytest.fixture
def path(tmp_path):
    """A robot whose body reaches 150 mm ahead of the axle, in a file in millimetres whose origin is above the axle."""
    (tmp_path / "parts").mkdir()
    nose = trimesh.creation.box((240.0, 100.0, 40.0), trimesh.transformations.translation_matrix((30.0, 0.0, 0.0)))
    nose.export(tmp_path / "parts/hull.stl")
    robot = tmp_path / "nosed.yaml"
    robot.write_text(
        "extends: nominal\nname: nosed\nassets: parts\n"
        "body: {mesh: {file: hull.stl, scale: 0.001}, z_m: 0.04, color: [0.4, 0.05, 0.02]}\n"
    )
    return str(robot)


@pytest.fixture
def robot(path):
    return draw_robot(load_section("robot", path), 1, "test")[0]


def test_the_body_is_where_its_file_says_in_the_axes_of_the_robot(robot):
    parts = {mesh.name: np.array(mesh.vertices) for mesh in robot_body(robot)}
    assert parts["robot_body"].min(axis=0) == pytest.approx((-0.09, -0.05, 0.02), abs=1e-6)
    assert parts["robot_body"].max(axis=0) == pytest.approx((0.15, 0.05, 0.06), abs=1e-6)
    assert "robot_plate" not in parts
    assert {"robot_tyre_left", "robot_tof_front", "robot_camera"} <= parts.keys()
    assert "robot_body" in {surface.name for surface in robot_surfaces(robot)}


def test_it_touches_with_its_hull_and_rolls_as_before(robot):
    nominal, _ = draw_robot(load_section("robot", "nominal"), 1, "test")
    rates = draw_run(load_scenario("smoke"), "CW", 1).rates
    touched = {}
    for name, one in (("nosed", robot), ("nominal", nominal)):
        for face_m in (0.14, 0.16):
            wall = Box("wall", "wall", (face_m + 0.05, 0.0, 0.1), (0.1, 1.0, 0.2), 0.0, "wood")
            arena = Arena("test", 4.0, 0.85, Line((), 0.015, 0.05), (wall,))
            with BulletSimulation(one, arena, (0.0, 0.0, 0.0), rates) as world:
                world.advance(20)
                touched[name, face_m] = world.touching()
    # Without its nose the robot ends 90 mm ahead of the axle.
    assert touched["nosed", 0.14] == ("wall",)
    assert [touched[key] for key in touched if key != ("nosed", 0.14)] == [(), (), ()]
    empty = Arena("test", 4.0, 0.85, Line((), 0.015, 0.05), ())
    poses = []
    for one in (robot, nominal):
        with BulletSimulation(one, empty, (0.0, 0.0, 0.0), rates) as world:
            world.set_voltages(3.0, 2.5)
            world.advance(500)
            poses.append(world.pose())
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-9)


def test_a_scaled_robot_has_a_scaled_body(path, tmp_path):
    small = tmp_path / "small.yaml"
    small.write_text(f"extends: {path}\nscale: 0.5\nname: small\n")
    robot, _ = draw_robot(load_section("robot", str(small)), 1, "test")
    body = next(mesh for mesh in robot_body(robot) if mesh.name == "robot_body")
    assert np.array(body.vertices).max(axis=0) == pytest.approx((0.075, 0.025, 0.03), abs=1e-6)


def test_a_file_that_is_not_there_is_refused_and_shipped_robots_have_no_body(path, tmp_path):
    (tmp_path / "parts/hull.stl").unlink()
    with pytest.raises(InputError, match=r"robot\.body\.mesh\.file: no such file"):
        load_section("robot", path)
    nominal = load_section("robot", "nominal").tree
    assert "body" not in nominal
    assert '"body"' not in RobotConfig.model_validate(nominal).model_dump_json()
