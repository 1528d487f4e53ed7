"""QTR-8A: what the channels read over a tape, against closed forms and the paper's Fig. 5."""

import math

import numpy as np
import pytest

from physics.control.following import line_error
from sensors.line.line_sensor import LineSensorModel, channel_weights, tape_share
from symolo.arena.geometry import Arc, Line, Straight

PITCH_M = 0.009525


def sensor(robot, arena, seed=0, **changes):
    quiet = {"gain_sd": 0.0, "offset_sd": 0.0, "noise_sd": 0.0, "dropout_probability": 0.0} | changes
    config = robot.line_sensor.model_copy(update=quiet)
    return LineSensorModel(config, arena, 1000, np.random.default_rng(seed))


def test_the_row_spans_33_mm_to_either_side():
    positions_mm = 1e3 * PITCH_M * channel_weights(8)
    assert positions_mm[0] == pytest.approx(-33.3, abs=0.05)
    assert positions_mm[-1] == pytest.approx(33.3, abs=0.05)


@pytest.mark.parametrize(
    ("robot_y_m", "active", "error"),
    [
        (0.0, [3, 4], 0.0),  # aligned with the line: the two middle channels, error 0
        (-0.5 * PITCH_M, [4], 0.5),  # misaligned to the right: channel 4 alone, error +0.5
        (0.5 * PITCH_M, [3], -0.5),
    ],
)
def test_the_middle_channels_react_as_in_figure_5(robot, arena_of, plane_world, robot_y_m, active, error):
    readings = sensor(robot, arena_of()).sample(plane_world(at=(0.0, robot_y_m, 0.0)))
    threshold = robot.line_sensor.threshold
    assert [i for i, reading in enumerate(readings) if reading < threshold] == active
    assert line_error(tuple(readings), threshold) == error


def test_half_a_spot_on_the_edge_reads_half_the_contrast():
    line = Line((Straight((-1.0, 0.0), (1.0, 0.0)),), 0.1, 0.0)
    assert tape_share(line, np.array([[0.0, 0.05]]), 0.001)[0] == pytest.approx(0.5, abs=1e-9)


def test_the_share_on_a_straight_tape_is_that_of_a_gaussian_spot():
    width, sd, offset = 0.015, 0.00125, 0.0068
    line = Line((Straight((-1.0, 0.0), (1.0, 0.0)),), width, 0.0)
    expected = 0.5 * (
        math.erf((offset + width / 2) / sd / math.sqrt(2)) - math.erf((offset - width / 2) / sd / math.sqrt(2))
    )
    assert tape_share(line, np.array([[0.2, offset]]), sd)[0] == pytest.approx(expected, abs=1e-12)


def test_the_share_on_an_arc_is_that_of_a_sampled_spot():
    line = Line((Arc((0.0, 0.0), 0.25, 0.0, math.pi / 2),), 0.015, 0.0)
    rng = np.random.default_rng(3)
    spot = rng.normal(0.0, 0.00125, (400_000, 2))
    for radius in (0.2415, 0.2425, 0.25, 0.2572, 0.259):
        centre = radius * np.array([math.cos(0.7), math.sin(0.7)])
        sampled = line.covers(centre + spot).mean()
        assert tape_share(line, centre[None], 0.00125)[0] == pytest.approx(sampled, abs=0.004)


def test_two_pieces_end_to_end_are_one_tape():
    joined = Line((Straight((-1.0, 0.0), (0.0, 0.0)), Straight((0.0, 0.0), (1.0, 0.0))), 0.015, 0.0)
    whole = Line((Straight((-1.0, 0.0), (1.0, 0.0)),), 0.015, 0.0)
    points = np.stack([np.linspace(-0.01, 0.01, 21), np.full(21, 0.006)], axis=1)
    np.testing.assert_allclose(tape_share(joined, points, 0.00125), tape_share(whole, points, 0.00125), atol=1e-12)


def test_readings_are_whole_steps_of_a_10_bit_converter(robot, arena_of, plane_world):
    readings = sensor(robot, arena_of(), noise_sd=0.01, gain_sd=0.05).sample(plane_world(at=(0.0, 0.003, 0.2)))
    steps = readings * 1023
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    assert readings.min() >= 0.0
    assert readings.max() <= 1.0


def test_a_higher_sensor_sees_a_softer_edge(robot, arena_of, plane_world):
    """10-90 % of a Gaussian edge is 2.563 standard deviations wide, and a disc's is a quarter of its diameter."""
    for height_m in (0.003, 0.010):
        model = sensor(robot, arena_of(), height_m=height_m, adc_bits=16)
        sd = 0.25 * (robot.line_sensor.spot_diameter_at_floor_m + robot.line_sensor.spot_growth * height_m)
        across = np.linspace(0.0, 0.02, 2001)
        # Channel 4 sits half a pitch to the left of the robot's middle.
        edge = np.array([model.sample(plane_world(at=(0.0, y - 0.5 * PITCH_M, 0.0)))[4] for y in across])
        width = across[np.searchsorted(edge, 0.9)] - across[np.searchsorted(edge, 0.1)]
        assert width == pytest.approx(2.563 * sd, abs=3e-5)


def test_a_lost_reading_repeats_the_one_before(robot, arena_of, plane_world):
    model = sensor(robot, arena_of())
    on_the_line = model.sample(plane_world(at=(0.0, 0.0, 0.0)))
    channels = model._channels
    channels._errors = channels._errors.model_copy(update={"dropout_probability": 1.0})
    np.testing.assert_array_equal(model.sample(plane_world(at=(0.0, 0.02, 0.0))), on_the_line)


def test_gains_differ_between_channels_but_not_within_a_run(robot, arena_of, plane_world):
    model = sensor(robot, arena_of(), gain_sd=0.05, adc_bits=16)
    off_the_line = plane_world(at=(0.0, 1.0, 0.0))
    first, second = model.sample(off_the_line), model.sample(off_the_line)
    np.testing.assert_array_equal(first, second)
    assert len(set(first)) > 1
