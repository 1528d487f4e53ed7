"""The bumper closes where something pushes it in."""

import numpy as np
import pytest

from configs.loader import load_scenario
from physics.arena.rays import RayScene
from sensors.bumper import Bumper, BumperSettings
from symolo.arena.geometry import Arena, Box, Line
from symolo.core.errors import InputError


class Still:
    time_s = 0.0

    def __init__(self, *boxes):
        self.arena = Arena("test", 20.0, 0.8, Line((), 0.015, reflectance=0.0), boxes)

    def pose(self):
        return 0.0, 0.0, 0.0

    def cast(self, origins, ends):
        return RayScene(self.arena).cast(origins, ends)


def pressed(box, **settings):
    world, rng = Still(box), np.random.default_rng(0)
    return Bumper(BumperSettings.model_validate(settings), world.arena, 1000, rng).sample(world).tolist()


def post(x_m, y_m, height_m=0.1):
    """A post of 10 mm whose nearest face is at x."""
    return Box("post", "obstacle", (x_m + 0.005, y_m, 0.5 * height_m), (0.01, 0.01, height_m), 0.0, "wood")


def test_it_closes_when_it_has_been_pushed_in_by_its_travel():
    # The bar is 15 mm before the body at x = 0.09 m and closes after 3 mm: at 0.102 m.
    assert pressed(post(0.103, 0.0)) == [0.0]
    assert pressed(post(0.101, 0.0)) == [1.0]


def test_it_stays_closed_while_the_body_touches():
    # The engine lets bodies overlap by a fraction of a millimetre, and those that drive into the robot by more.
    assert pressed(post(0.09, 0.0)) == [1.0]
    assert pressed(post(0.0895, 0.0)) == [1.0]
    assert pressed(post(0.085, 0.0)) == [1.0]


def test_each_zone_has_a_switch_from_right_to_left():
    assert pressed(post(0.1, 0.05), zones=3) == [0.0, 0.0, 1.0]
    assert pressed(post(0.1, 0.0), zones=3) == [0.0, 1.0, 0.0]
    assert pressed(post(0.1, -0.05), zones=3) == [1.0, 0.0, 0.0]
    assert pressed(post(0.1, 0.1), zones=3) == [0.0, 0.0, 0.0]  # beside the bar


def test_it_faces_where_it_is_mounted_and_passes_over_what_is_lower():
    assert pressed(post(-0.11, 0.0), x_m=-0.09, yaw_deg=180) == [1.0]
    assert pressed(post(0.1, 0.0, height_m=0.03), z_m=0.04) == [0.0]


def test_a_travel_beyond_the_reach_is_refused():
    with pytest.raises(InputError, match=r"bumper\.travel_m: got 0\.02, allowed: less than reach_m"):
        load_scenario("smoke", ["robot.sensors.bumper.travel_m=0.02"])
