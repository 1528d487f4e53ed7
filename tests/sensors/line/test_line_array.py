"""Further line sensors: any number of channels at any places."""

import numpy as np
import pytest

from configs.loader import load_scenario
from sensors.line.line_array import LineArray, LineArraySettings
from sensors.line.line_sensor import LineSensorModel
from symolo.core.errors import InputError

QUIET = {"gain_sd": 0.0, "offset_sd": 0.0, "noise_sd": 0.0}


def read(arena, world, seed=0, **settings):
    device = LineArray(LineArraySettings.model_validate(settings), arena, 1000, np.random.default_rng(seed))
    return device.sample(world)


def test_eight_channels_of_the_nominal_row_read_as_the_nominal_sensor(robot, arena_of, plane_world):
    world = plane_world(at=(0.0, 0.004, 0.1))
    nominal = LineSensorModel(robot.line_sensor, arena_of(), 1000, np.random.default_rng(3)).sample(world)
    np.testing.assert_array_equal(read(arena_of(), world, seed=3, x_m=robot.line_sensor.x_m), nominal)


def test_channels_are_where_the_list_says(arena_of, plane_world):
    # The tape runs along x through the origin: only channels within 7.5 mm of it are dark.
    places = [[0.0, 0.03], [0.05, 0.0], [-0.05, 0.0], [0.0, -0.03]]
    seen = read(arena_of(), plane_world(at=(0.0, 0.0, 0.0)), places=places, **QUIET)
    np.testing.assert_allclose(seen, [1, 0, 0, 1], atol=1e-3)
    turned = read(arena_of(), plane_world(at=(0.0, 0.0, 0.0)), places=places, yaw_deg=90.0, **QUIET)
    np.testing.assert_allclose(turned, [0, 1, 1, 0], atol=1e-3)
    moved = read(arena_of(), plane_world(at=(0.0, 0.0, 0.0)), places=places, y_m=0.03, **QUIET)
    np.testing.assert_allclose(moved, [1, 1, 1, 0], atol=1e-3)


def test_a_row_of_any_number_counts_from_right_to_left(arena_of, plane_world):
    row = read(arena_of(), plane_world(at=(0.0, -0.02, 0.0)), channels=5, pitch_m=0.02, **QUIET)
    np.testing.assert_allclose(row, [1, 1, 1, 0, 1], atol=1e-3)  # the tape is 20 mm to the left


def test_a_comparator_gives_black_or_white(arena_of, plane_world):
    row = read(arena_of(), plane_world(at=(0.0, 0.0075, 0.0)), channels=16, pitch_m=0.001, adc_bits=1, **QUIET)
    assert set(row) == {0.0, 1.0}


def test_effects_act_on_all_channels_and_those_of_one_of_the_eight_are_refused(arena_of, plane_world):
    world = plane_world(at=(0.0, 0.0, 0.0))
    settings = {"channels": 2, "pitch_m": 0.06, **QUIET}
    bright = read(arena_of(), world, effects={"line_height": {"height_scale": 2.0}}, **settings)
    np.testing.assert_allclose(bright, 0.25 * read(arena_of(), world, **settings), atol=1e-3)
    with pytest.raises(InputError, match=r"effects\.line_gain: it does not act on this sensor"):
        load_scenario("smoke", ["robot.sensors.line_array.effects.line_gain={channel: L0, scale: 2}"])
