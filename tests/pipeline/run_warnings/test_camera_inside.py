"""Images from inside walls and obstacles of an arena that does not fit the path."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.run_warnings.camera_inside import inside_warnings, things_around
from pipeline.stages.cameras import cameras_of
from symolo.dataset.tables.rows import Rows

ROUTE = "routes=[{name: CW, start: {x_m: 0, y_m: 0, yaw_deg: 0}}]"
ON_AXLE = ("robot.camera.x_m=0", "robot.camera.height_above_base_m=0.05")
"""The camera is above the middle of the axle, 0.1 m above the floor."""
BOX = "{name: Box, center: [0.5, 0], size: [0.2, 0.2, 0.3], yaw_deg: 45}"


def spec_of(*settings):
    arena = ("arena.walls=[]", "arena.obstacles=[]", "arena.line.pieces=[]")
    (spec,) = draw_all(load_scenario("smoke", [ROUTE, *ON_AXLE, *arena, *settings]))
    return spec


@pytest.fixture
def rows():
    """A drive of 1 m along x in 10 s, with an image in each second."""
    t_ms = np.arange(0, 10_001, 100)
    zero = 0.0 * t_ms
    image = np.where(t_ms % 1000 == 0, t_ms // 1000 + 1, 0)
    nothing = np.zeros((len(t_ms), 8))
    pose = np.stack([1e-4 * t_ms, zero, zero], axis=1)
    return Rows(t_ms, pose, 0 * t_ms, nothing[:, :2], nothing[:, :3], nothing, image)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        # The diagonal of the box along x is 0.283 m: from 0.359 m to 0.641 m, with three images.
        ([f"arena.obstacles=[{BOX}]"], "at 4.0 s the camera is inside obstacle Box, as in 3 of 11 images: move"),
        (
            ["arena.walls=[{name: A, start: [0.32, -1], end: [0.32, 1], thickness_m: 0.05}]"],
            "at 3.2 s the robot drives through wall A, at x = 0.32, y = 0.00 m",
        ),
        (
            ["arena.obstacles=[{name: Sill, center: [0.5, 0], size: [0.2, 0.2, 0.08]}]"],
            "at 4.0 s the robot drives through obstacle Sill, at x = 0.40, y = 0.00 m",
        ),
    ],
)
def test_a_path_through_a_thing_is_a_warning(rows, settings, message):
    (warning,) = inside_warnings(spec_of(*settings), rows)
    assert warning.startswith(message)


@pytest.mark.parametrize(
    "setting",
    [
        "arena.obstacles=[{name: Beside, center: [0.5, 0.15], size: [0.2, 0.2, 0.3]}]",
        "arena.obstacles=[{name: Mat, center: [0.5, 0], size: [0.2, 0.2, 0.08], solid: false}]",
        "arena.walls=[{name: A, start: [1.1, -1], end: [1.1, 1]}]",
    ],
)
def test_a_path_beside_things_gets_no_warning(rows, setting):
    assert inside_warnings(spec_of(setting), rows) == ()


def test_a_moving_obstacle_is_where_it_is_at_the_time_of_the_image(rows):
    """It moves with the camera, which is 0.05 m ahead of its rear side."""
    path = "motion: {waypoints: [{t_s: 10, offset: [1, 0]}]}"
    spec = spec_of(f"arena.obstacles=[{{name: Cart, center: [0.05, 0], size: [0.2, 0.2, 0.3], solid: false, {path}}}]")
    assert inside_warnings(spec, rows)[0].startswith(
        "at 0.0 s the camera is inside obstacle Cart, as in 11 of 11 images"
    )
    (camera,) = cameras_of(spec)
    assert things_around(camera, rows) == dict.fromkeys(range(1, 12), "obstacle Cart")


def test_an_obstacle_that_drives_through_a_robot_that_stands_is_a_warning(rows):
    """The cart is 0.2 m long, starts 1 m away and moves at 0.4 m/s, so that it reaches the axle after 2.25 s."""
    still = replace(rows, pose=0.0 * rows.pose)
    motion = "{waypoints: [{t_s: 5, offset: [2, 0]}]}"
    cart = f"{{name: Cart, center: [-1, 0], size: [0.2, 0.2, 0.08], motion: {motion}}}"
    (warning,) = inside_warnings(spec_of(f"arena.obstacles=[{cart}]"), still)
    assert warning.startswith("at 2.3 s the robot drives through obstacle Cart")


@pytest.fixture
def mesh_of(tmp_path):
    """Write a trimesh body as a file, and return the settings of an obstacle at x = 0.5 m with this shape."""

    def settings(body, center="[0.5, 0]"):
        body.export(tmp_path / "body.stl")
        return [
            f"arena.assets={tmp_path}",
            f"arena.obstacles=[{{name: Thing, center: {center}, yaw_deg: 90, mesh: {{file: body.stl}}}}]",
        ]

    return settings


def test_the_inside_of_a_mesh_is_that_of_its_triangles(rows, mesh_of):
    """A ball of 0.12 m, with its middle 0.08 m beside the path and 0.02 m above the camera: it has 0.413 to 0.587 m."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=3, radius=0.12), "[0.5, 0.08]")
    (warning,) = inside_warnings(spec_of(*ball), rows)
    assert warning.startswith("at 5.0 s the camera is inside obstacle Thing, as in 1 of 11 images: move")


def test_a_path_between_the_legs_of_a_table_gets_no_warning_and_one_through_a_leg_does(rows, mesh_of):
    legs = [
        trimesh.creation.box((0.04, 0.04, 0.4), trimesh.transformations.translation_matrix((x, y, 0.2)))
        for x in (-0.3, 0.3)
        for y in (-0.2, 0.2)
    ]
    top = trimesh.creation.box((0.7, 0.5, 0.03), trimesh.transformations.translation_matrix((0, 0, 0.41)))
    table = mesh_of(trimesh.util.concatenate([*legs, top]))
    assert inside_warnings(spec_of(*table), rows) == ()
    # Turned by 90 degrees, the legs are at x = 0.3 m and 0.7 m, and y = -0.3 m and 0.3 m.
    beside = replace(rows, pose=np.add(rows.pose, (0.0, 0.3, 0.0)), image=0 * rows.image)
    (warning,) = inside_warnings(spec_of(*table), beside)
    assert warning.startswith("at 2.8 s the robot drives through obstacle Thing, at x = 0.28, y = 0.30 m")
