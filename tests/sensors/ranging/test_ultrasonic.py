"""The ultrasonic sensor: first echo, mirror-like walls, speed of sound."""

import numpy as np
import pytest

from physics.arena.rays import RayScene
from sensors.ranging.ultrasonic import Ultrasonic, UltrasonicSettings
from symolo.arena.geometry import Arena, Box, Line

PERFECT = {"noise_m": 0.0, "quantisation_m": 0.0, "dropout_probability": 0.0, "z_m": 0.5}


class Still:
    time_s = 0.0

    def __init__(self, *boxes):
        self.arena = Arena("test", 20.0, 0.8, Line((), 0.015, reflectance=0.0), boxes)

    def pose(self):
        return 0.0, 0.0, 0.0

    def cast(self, origins, ends):
        return RayScene(self.arena).cast(origins, ends)


def wall(x_m, tilt_deg=0.0, width_m=4.0):
    """A wall whose face meets the x axis at a distance, turned about this point."""
    tilt = np.radians(tilt_deg)
    middle = x_m + 0.5 * np.cos(tilt), 0.5 * np.sin(tilt), 1.0
    return Box(f"wall_{x_m}", "wall", middle, (1.0, width_m, 2.0), tilt, "white_board")


def reading(*boxes, seed=0, **settings):
    world = Still(*boxes)
    device = Ultrasonic(
        UltrasonicSettings.model_validate({**PERFECT, **settings}), world.arena, 1000, np.random.default_rng(seed)
    )
    return device.sample(world)[0]


def test_a_wall_head_on_reads_its_distance():
    # The first of 120 rays is up to 1 degree from the axis, so that it is 0.02 % longer.
    for distance_m in (0.05, 0.5, 3.0):
        assert reading(wall(distance_m)) == pytest.approx(distance_m, rel=1e-3)


def test_the_first_echo_counts_and_not_the_mean():
    post = Box("post", "obstacle", (0.6, 0.03, 0.5), (0.2, 0.06, 1.0), 0.0, "wood")
    assert reading(wall(1.0), post) == pytest.approx(0.5, abs=2e-3)


def test_a_smooth_wall_at_a_slant_reflects_the_sound_away():
    assert reading(wall(1.0, tilt_deg=5)) > 0
    assert reading(wall(1.0, tilt_deg=45)) == 0.0
    assert reading(wall(1.0, tilt_deg=45), scatter_deg=60.0) > 0  # a rough one scatters it


def test_beyond_its_range_there_is_no_echo():
    assert reading(wall(3.9)) > 0
    assert reading(wall(4.1)) == 0.0
    assert reading(wall(0.01)) == 0.0


def test_in_warm_air_sound_is_faster_and_ranges_are_shorter():
    # The speed of sound is proportional to the root of the absolute temperature: 331.3 m/s at 0 and 343.2 m/s at 20 C.
    assert reading(wall(1.0), air_temperature_C=0.0) == pytest.approx(343.2 / 331.3, rel=1e-3)


def test_readings_have_steps_and_drop_out():
    step = 0.01
    assert reading(wall(0.5), quantisation_m=step) / step == pytest.approx(50)
    missed = [reading(wall(0.5), seed=seed, dropout_probability=0.3, rays=1) == 0.0 for seed in range(400)]
    assert np.mean(missed) == pytest.approx(0.3, abs=0.07)
