"""The 2D lidar: its rays, its errors, and what the motion of the robot does to a scan."""

import json
from dataclasses import dataclass, field

import numpy as np
import pytest

from configs.draw import draw_robot, draw_run
from configs.loader import load_scenario, load_section
from physics.arena.rays import RayScene
from physics.bullet.ray_oracle import EngineRays
from pipeline.stages.simulate import simulate
from sensors.ranging.lidar import Lidar, LidarSettings
from symolo.arena.geometry import Arena, Box, Line
from symolo.core.errors import InputError

PERFECT = {
    "noise_m": 0.0,
    "noise_share": 0.0,
    "offset_sd_m": 0.0,
    "intensity_noise": 0.0,
    "quantisation_m": 0.0,
    "dropout_probability": 0.0,
}


def room(*boxes):
    return Arena("test", 20.0, 0.8, Line((), 0.015, reflectance=0.0), boxes)


def wall(x_m, surface="white_board", height_m=1.0):
    return Box("wall", "wall", (x_m + 0.5, 0.0, 0.5 * height_m), (1.0, 40.0, height_m), 0.0, surface)


@dataclass
class TurningWorld:
    """A robot that turns on the spot at the origin of an arena."""

    arena: Arena
    rate_rad_s: float = 0.0
    time_s: float = 0.0
    cast_at: list = field(default_factory=list)

    def pose(self):
        return 0.0, 0.0, self.rate_rad_s * self.time_s

    def cast(self, origins, ends, time_s=None):
        self.cast_at.append(time_s)
        return RayScene(self.arena).cast(origins, ends, self.time_s if time_s is None else time_s)


def lidar(arena, seed=0, **settings):
    return Lidar(LidarSettings.model_validate({**PERFECT, **settings}), arena, 1000, np.random.default_rng(seed))


def scan(arena, **settings):
    values = lidar(arena, **settings).sample(TurningWorld(arena))
    return np.split(values, 2)


def test_a_ray_ends_where_the_wall_is():
    range_m, intensity = scan(room(wall(2.0)), rays=3, first_ray_deg=-30, ray_step_deg=30)
    np.testing.assert_allclose(range_m, [2 / np.cos(np.pi / 6), 2, 2 / np.cos(np.pi / 6)], atol=1e-9)
    # Lambert: the returned light is reflectance times the cosine of the incidence, 0.85 for a white board.
    np.testing.assert_allclose(intensity, [0.85 * np.cos(np.pi / 6), 0.85, 0.85 * np.cos(np.pi / 6)], atol=1e-9)


def test_rays_start_at_the_place_of_the_sensor_and_count_from_its_direction():
    settings = {"rays": 1, "first_ray_deg": 90.0, "x_m": 0.1, "y_m": -0.05, "yaw_deg": -90.0}
    assert scan(room(wall(2.0)), **settings)[0] == pytest.approx([1.9])
    down = {"rays": 1, "first_ray_deg": 0.0, "pitch_up_deg": -30.0, "z_m": 0.1}
    assert scan(room(), **down)[0] == pytest.approx([0.2])  # the floor, at 30 degrees


def test_what_is_too_near_too_far_or_too_dark_returns_nothing():
    beam = {"rays": 1, "first_ray_deg": 0.0, "min_range_m": 0.1, "max_range_m": 4.0}
    seen = {x_m: scan(room(wall(x_m)), **beam)[0][0] for x_m in (0.05, 0.2, 3.9, 4.1)}
    assert seen == {0.05: 0.0, 0.2: pytest.approx(0.2), 3.9: pytest.approx(3.9), 4.1: 0.0}
    # 0.05 of reflectance returns as much at sqrt(0.05 / 0.1) of 4 m as 0.1 returns there: at 2.83 m.
    black = {x_m: scan(room(wall(x_m, "black_board")), **beam)[0][0] > 0 for x_m in (2.80, 2.86)}
    assert black == {2.80: True, 2.86: False}


def test_noise_grows_with_the_range_and_rays_drop_out():
    errors = {"noise_m": 0.003, "noise_share": 0.01, "dropout_probability": 0.1}
    for x_m, expected_m in ((0.3, np.hypot(0.003, 0.003)), (3.0, np.hypot(0.003, 0.03))):
        device = lidar(room(wall(x_m)), rays=5000, first_ray_deg=0.0, ray_step_deg=1e-9, **errors)
        range_m = device.sample(TurningWorld(device.arena))[:5000]
        valid = range_m[range_m > 0]
        assert len(valid) / 5000 == pytest.approx(0.9, abs=0.02)
        assert valid.std() == pytest.approx(expected_m, rel=0.05)
        assert valid.mean() == pytest.approx(x_m, abs=4 * expected_m / np.sqrt(4500))


def test_a_scan_of_a_turning_robot_is_skewed_by_the_time_of_each_ray():
    arena, rate = room(wall(2.0)), 1.0
    device = lidar(arena, rays=11, first_ray_deg=-50, ray_step_deg=10)
    world = TurningWorld(arena, rate)
    assert device.sampling.subsamples_before == tuple(range(100, 0, -10))
    for step in (*range(0, 100, 10), 100):
        world.time_s = step / 1000
        range_m = device.sample(world)[:11] if step == 100 else device.subsample(world)
    late_s = 0.1 * (np.arange(11) - 10) / 11
    angles = np.radians(np.arange(-50, 51, 10)) + rate * (0.1 + late_s)
    np.testing.assert_allclose(range_m, 2 / np.cos(angles), atol=1e-9)
    assert world.cast_at == [None]  # nothing moves, so one batch


def spec_of(scenario, *settings):
    perfect = [f"robot.sensors.lidar.{key}={value}" for key, value in PERFECT.items()]
    return draw_run(load_scenario(scenario, [*perfect, *settings]), "CW", 1)


def test_ranges_agree_with_the_rays_of_pybullet():
    arena = Arena.from_config(spec_of("symolo").arena)
    with EngineRays(arena) as engine:

        class EngineWorld(TurningWorld):
            def cast(self, origins, ends, time_s=None):
                assert time_s is None
                return engine.cast(origins, ends)

        worlds = TurningWorld(arena), EngineWorld(arena)
        ours, theirs = (lidar(arena, z_m=0.1).sample(world)[:360] for world in worlds)
    both = (ours > 0) & (theirs > 0)
    assert both.sum() > 100
    assert np.mean((ours > 0) == (theirs > 0)) > 0.99
    # PyBullet's rays are wrong by up to 3 mm near edges (`EngineRays`).
    assert np.abs(ours - theirs)[both].max() < 4e-3
    assert np.median(np.abs(ours - theirs)[both]) < 1e-4


def test_a_run_has_a_scan_every_100_ms_that_meets_the_moving_obstacles():
    spec = spec_of("moving", "robot.sensors.lidar.sweep_s=0", "stop.time_limit_s=1", "stop.lap=false")
    recording = simulate(spec).recording
    series = recording["sensor_lidar"]
    np.testing.assert_allclose(series.t_s, np.arange(11) * 0.1)
    arena = Arena.from_config(spec.arena)
    assert arena.moving
    angles = np.radians(np.arange(-180, 180))
    for row in (0, 10):
        x, y, yaw = recording.trajectory.pose[2 * row]
        origins = np.tile([x, y, 0.1], (360, 1))
        ways = np.stack([np.cos(yaw + angles), np.sin(yaw + angles), np.zeros(360)], axis=1)
        hits = RayScene(arena).cast(origins, origins + 10 * ways, float(series.t_s[row]))
        seen = series.values[row, :360]
        np.testing.assert_allclose(seen[seen > 0], 10 * hits.fraction[seen > 0], atol=1e-9)
        assert np.count_nonzero(seen) > 100


@pytest.mark.parametrize(
    ("settings", "step_deg"),
    [({}, 1.0), ({"rays": 90}, 4.0), ({"rays": 1}, 1.0), ({"rays": 90, "ray_step_deg": -1.5}, -1.5)],
)
def test_rays_look_all_around_unless_their_step_is_stated(settings, step_deg):
    robot, _ = draw_robot(load_section("robot", "nominal", [f"robot.sensors.lidar={json.dumps(settings)}"]), 1, "test")
    assert dict(robot.sensors)["lidar"].ray_step_deg == step_deg


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("min_range_m=9", r"min_range_m: got 9(\.0)?, allowed: less than max_range_m"),
        ("sweep_s=0.2", r"sweep_s: got 0\.2, allowed: at most period_s"),
        ("ray_step_deg=2", r"ray_step_deg: got 2(\.0)?, allowed: an angle other than 0 of at most 1"),
        ("rays={uniform: [100, 200]}", "no distribution is allowed here, because it decides the columns"),
    ],
)
def test_impossible_rays_are_refused(setting, message):
    with pytest.raises(InputError, match=message):
        load_scenario("smoke", [f"robot.sensors.lidar.{setting}"])
