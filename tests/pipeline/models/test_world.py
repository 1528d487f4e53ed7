"""The arena's file is read by PyBullet, and held against the bodies and the rays of the simulation."""

from math import cos, radians, sin
from xml.etree import ElementTree as ET

import numpy as np
import pybullet
import pytest

from physics.arena.rays import RayScene
from physics.bullet.ray_oracle import BATCH, EngineRays
from physics.bullet.world import add_arena, connect
from pipeline.models.files import model_files
from sensors.ranging.tof import ray_directions, ray_pattern
from symolo.arena.geometry import Arena, Box


@pytest.fixture(scope="module")
def arena(spec) -> Arena:
    return Arena.from_config(spec.arena)


@pytest.fixture(scope="module")
def world(models) -> ET.Element:
    return ET.parse(models / "arena.sdf").find("world")  # noqa: S314 - a file that was written above


@pytest.fixture(scope="module")
def loaded(models):
    """PyBullet's client, and the numbers of the bodies that it makes of the file."""
    client = connect(1000)
    floor, _line, *boxes = pybullet.loadSDF(str(models / "arena.sdf"), physicsClientId=client)
    # Else rays go by where the bodies were before they were placed.
    pybullet.performCollisionDetection(physicsClientId=client)
    yield client, (floor, *boxes)
    pybullet.disconnect(client)


@pytest.fixture(scope="module")
def tof_rays(spec) -> tuple[np.ndarray, np.ndarray]:
    """Origins and ends in W of all beams of the three sensors, from places all over the arena."""
    tof = spec.robot.tof
    pattern = ray_pattern(tof.rays, radians(tof.field_of_view_deg))
    origins, ends = [], []
    rng = np.random.default_rng(5)
    for x, y, yaw in zip(rng.uniform(-0.5, 0.5, 40), rng.uniform(-0.7, 0.7, 40), rng.uniform(-3, 3, 40), strict=True):
        turn = np.array([[cos(yaw), sin(yaw), 0], [-sin(yaw), cos(yaw), 0], [0, 0, 1]])
        for mount in (tof.mounts.front, tof.mounts.left, tof.mounts.right):
            origin = np.array([mount.x_m, mount.y_m, mount.z_m]) @ turn + (x, y, 0)
            directions = ray_directions(mount, *pattern) @ turn
            origins.append(np.tile(origin, (tof.rays, 1)))
            ends.append(origin + 1.5 * directions)
    return np.concatenate(origins), np.concatenate(ends)


def test_the_loaded_arena_has_the_bodies_of_the_simulated_one(arena, loaded):
    client, bodies = loaded
    own = connect(1000)
    expected = [pybullet.getAABB(body, physicsClientId=own) for body in add_arena(own, arena)]
    boxes = [pybullet.getAABB(body, physicsClientId=client) for body in bodies]
    # The floor goes on for ever here and there.
    assert len(boxes) == len(expected)
    assert np.array(boxes[1:]) == pytest.approx(np.array(expected[1:]), abs=1e-9)
    pybullet.disconnect(own)


def test_a_ray_of_the_engine_goes_as_far_in_the_loaded_arena(arena, loaded, tof_rays):
    """But for those that graze an edge, which the engine rounds, of a loaded box by more than of one that is made."""
    client, _ = loaded
    with EngineRays(arena) as simulated:
        expected = simulated.cast(*tof_rays)
    origins, ends = tof_rays
    met = [
        ray[2]
        for first in range(0, len(origins), BATCH)
        for ray in pybullet.rayTestBatch(
            origins[first : first + BATCH], ends[first : first + BATCH], physicsClientId=client
        )
    ]
    assert np.count_nonzero(expected.surface > 0) > 1000
    assert np.count_nonzero(np.abs(1.5 * (np.array(met) - expected.fraction)) > 1e-6) < 1e-3 * len(met)


def test_a_beam_of_the_simulation_goes_as_far_among_the_loaded_boxes(arena, loaded, tof_rays):
    """The engine's own rays are off by millimetres near edges: the loaded boxes are given to the simulation's."""
    client, bodies = loaded
    boxes = []
    for body in bodies[1:]:
        place, turn = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
        size = pybullet.getCollisionShapeData(body, -1, physicsClientId=client)[0][3]
        yaw = pybullet.getEulerFromQuaternion(turn)[2]
        boxes.append(Box("loaded", "wall", place, size, yaw, "white_board"))
    read = Arena("read", arena.floor_half_extent_m, arena.floor_reflectance, arena.line, tuple(boxes))
    found, expected = RayScene(read).cast(*tof_rays), RayScene(arena).cast(*tof_rays)
    assert found.surface.tolist() == expected.surface.tolist()
    assert 1.5 * found.fraction == pytest.approx(1.5 * expected.fraction, abs=1e-6)


def test_the_line_is_drawn_where_the_line_sensor_reads_it(arena, world):
    line = next(model for model in world.iter("model") if model.get("name") == "line")
    spots = np.random.default_rng(3).uniform((-1.0, -1.2), (1.0, 1.2), (60_000, 2))
    drawn = np.zeros(len(spots), dtype=bool)
    for visual in line.iter("visual"):
        x, y, _, _, _, yaw = map(float, visual.findtext("pose").split())
        length, width, _ = map(float, visual.findtext("geometry/box/size").split())
        away = (spots - (x, y)) @ np.array([[cos(yaw), -sin(yaw)], [sin(yaw), cos(yaw)]])
        drawn |= (np.abs(away) <= (0.5 * length, 0.5 * width)).all(axis=1)
    read = arena.line.covers(spots)
    wrong = spots[drawn != read]
    assert np.count_nonzero(read) > 500
    # Chords of 1 cm leave the bends, of 0.25 m or more, by no more than 0.05 mm.
    to_edge = [np.abs(np.abs(piece.local(wrong)[1]) - 0.5 * arena.line.width_m) for piece in arena.line.pieces]
    assert np.all(np.min(to_edge, axis=0) < 1e-4)


def test_nothing_touches_the_line(world):
    line = next(model for model in world.iter("model") if model.get("name") == "line")
    assert not list(line.iter("collision"))


def test_wheels_meet_the_floor_and_the_chassis_meets_walls(models, world):
    robot = ET.parse(models / "robot.sdf")  # noqa: S314 - as above
    bits = {
        collision.get("name"): int(collision.findtext("surface/contact/collide_bitmask"))
        for collision in robot.iter("collision")
    }
    arena = {
        model.get("name"): int(model.findtext("link/collision/surface/contact/collide_bitmask"))
        for model in world.iter("model")
        if model.get("name") != "line"
    }
    for name, bit in arena.items():
        for link in ("right_wheel", "left_wheel", "caster"):
            assert bool(bit & bits[f"{link}_collision"]) == (name == "floor")
        assert bool(bit & bits["base_link_collision"]) == (name != "floor")


def test_a_white_wall_is_lighter_than_a_cardboard_box(arena, world):
    red = {model.get("name"): model.findtext("link/visual/material/diffuse") for model in world.iter("model")}
    by_surface = {box.surface: float(red[f"{box.kind}_{box.name}"].split()[0]) for box in arena.boxes}
    assert by_surface["white_board"] > by_surface["cardboard"]


def test_the_robot_stands_at_the_start_of_the_run(models, spec):
    world = ET.parse(models / "world.sdf").find("world")  # noqa: S314 - as above
    robot = next(model for model in world.iter("model") if model.get("name") == spec.robot.name)
    pose = [float(number) for number in robot.findtext("pose").split()]
    start = spec.start
    assert pose == pytest.approx([start.x_m, start.y_m, 0, 0, 0, radians(start.yaw_deg)])


def test_the_same_run_gives_the_same_bytes(models, spec):
    for name, data in model_files(spec, ("urdf", "sdf")).items():
        assert (models / name).read_bytes() == data
