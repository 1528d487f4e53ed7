"""Experiments with the line sensor against closed forms and the paper's Fig. 5."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from configs.schema.arena import Floor, LineConfig
from configs.schema.robot import RobotConfig
from diagnosis.validation.line_sensor.channels import ROBOTS, channels, converter, spread
from diagnosis.validation.line_sensor.edge import crossing, edge_width_m, edges
from diagnosis.validation.line_sensor.experiments import require_threshold
from diagnosis.validation.line_sensor.rig import Tape
from diagnosis.validation.line_sensor.threshold import threshold
from symolo.core.errors import InputError

NOMINAL = Path(__file__).parents[3] / "configs" / "robots" / "nominal.yaml"
PITCH_M = 0.009525


@pytest.fixture(scope="module")
def robot():
    return RobotConfig.model_validate(yaml.safe_load(NOMINAL.read_text(encoding="utf-8")))


def with_line_sensor(robot, **settings):
    return robot.model_copy(update={"line_sensor": robot.line_sensor.model_copy(update=settings)})


def test_the_tape_is_that_of_an_arena_that_says_nothing_else():
    assert Tape() == Tape(LineConfig().width_m, LineConfig().reflectance, Floor().reflectance)


def test_every_channel_sees_the_edge_as_wide_as_its_spot_says(robot):
    result = edges(robot, 3)
    assert [table["height_m"] for table in result.tables.values()] == [0.003, 0.006]
    for table, check, diameter_m in zip(result.tables.values(), result.checks, (0.005, 0.008), strict=True):
        # 10-90 % of a normal distribution is 2.5631 standard deviations; a disc's is a quarter of its diameter.
        expected_m = 2.5631 * 0.25 * diameter_m
        assert table["edge_closed_form_m"] == pytest.approx(expected_m, rel=1e-4)
        assert table["edge_10_90_m"] == pytest.approx([expected_m] * 8, rel=0.005)
        assert check.passed


def test_a_spot_that_sees_both_edges_is_not_held_to_the_closed_form_of_one(robot):
    wide = with_line_sensor(robot, spot_diameter_at_floor_m=0.02)
    assert [check.passed for check in edges(wide, 3).checks] == [None, None]


def test_channels_meet_the_tape_in_the_order_of_their_places(robot):
    table = crossing(robot.line_sensor, 0.003, Tape(), seed=3)
    # A robot to the left of the tape by y has it under the channel that sits y to its right.
    middles = [float(table["offset_m"][table[f"faultless_L{k}"] < 0.45].mean()) for k in range(8)]
    assert middles == pytest.approx([PITCH_M * (3.5 - channel) for channel in range(8)], abs=1e-4)


def test_the_width_of_a_straight_slope_is_80_percent_of_it():
    offset = np.linspace(-0.02, 0.02, 4001)
    ink = np.clip((0.0075 - np.abs(offset)) / 0.003 + 0.5, 0.0, 1.0)
    assert edge_width_m(offset, 0.85 - 0.8 * ink, Tape()) == pytest.approx(0.8 * 0.003, abs=1e-6)


def test_channels_differ_as_configured(robot):
    result = channels(with_line_sensor(robot, gain_sd=0.05, offset_sd=0.02), 7)
    for name, mean, sd in (("gain", 1.0, 0.05), ("offset", 0.0, 0.02)):
        table = result.tables[name]
        assert len(table["values"]) == 8 * ROBOTS
        assert table["mean"] == pytest.approx(mean, abs=5 * sd / math.sqrt(8 * ROBOTS))
        assert table["sd"] == pytest.approx(sd, abs=5 * table["sd_error"])
    assert result.tables["gain"]["sd_error"] == pytest.approx(0.05 / math.sqrt(2 * 3999))
    assert all(check.passed for check in result.checks)


def test_equal_channels_have_no_spread(robot):
    gain = channels(with_line_sensor(robot, gain_sd=0.0, offset_sd=0.0), 7).tables["gain"]
    assert gain["sd"] < 1e-12
    assert gain["mean"] == pytest.approx(1.0, abs=1e-4)  # but for the finest converter's steps


def test_a_spread_is_that_of_a_sample():
    table = spread(np.array([1.0, 2.0, 3.0, 4.0]), 1.2)
    assert (table["mean"], table["sd"]) == (2.5, pytest.approx(math.sqrt(5.0 / 3.0)))
    assert table["sd_error"] == pytest.approx(1.2 / math.sqrt(6.0))


@pytest.mark.parametrize("bits", [1, 4, 10])
def test_a_converter_has_all_of_its_levels_in_equal_steps(robot, bits):
    levels, step, error = converter(with_line_sensor(robot, adc_bits=bits), 1).checks
    assert levels.value == 2**bits
    assert step.value == pytest.approx(1.0 / (2**bits - 1), rel=1e-9)
    assert error.value == pytest.approx(0.5 / (2**bits - 1), rel=1e-6)
    assert levels.passed
    assert step.passed
    assert error.passed


def test_the_threshold_behaves_as_in_figure_5(robot):
    result = threshold(robot, 1)
    aligned, right, left = list(result.tables.values())[1:]
    assert (aligned["active"], aligned["line_error"]) == ((3, 4), 0.0)
    assert right["offset_m"] < 0.0
    assert (right["active"], right["line_error"]) == ((4,), 0.5)
    assert (left["active"], left["line_error"]) == ((3,), -0.5)
    assert all(check.passed for check in result.checks)


def tapes_as_in_figure_5(result):
    return [result.check(f"{which} tape for which Fig. 5 holds") for which in ("narrowest", "widest")]


def test_figure_5_holds_from_one_to_two_pitches_of_tape(robot):
    narrowest, widest = tapes_as_in_figure_5(threshold(robot, 1))
    # Half of the contrast is 0.45, the threshold, so that a channel is on with its middle over the tape.
    assert narrowest.value == pytest.approx(1e3 * PITCH_M, abs=0.01)
    assert widest.value == pytest.approx(2e3 * PITCH_M, abs=0.01)


def test_a_lower_threshold_needs_more_tape(robot):
    narrowest, widest = tapes_as_in_figure_5(threshold(with_line_sensor(robot, threshold=0.25), 1))
    # 0.25 is reached with 75 % of the spot on the tape: 0.6745 standard deviations inside its edge.
    inside_mm = 0.6745 * 0.25 * 5.0
    assert narrowest.value == pytest.approx(1e3 * PITCH_M + 2 * inside_mm, abs=0.02)
    assert widest.value == pytest.approx(2e3 * PITCH_M + 2 * inside_mm, abs=0.02)


def test_a_tape_that_is_too_wide_is_not_as_in_figure_5(robot):
    result = threshold(robot, 1, Tape(width_m=0.025))
    assert not result.check("cases with other channels on").passed
    widest = tapes_as_in_figure_5(result)[1]
    assert math.isnan(widest.value)
    assert widest.passed is False


def test_a_threshold_that_never_distinguishes_tape_from_floor_is_refused(robot):
    require_threshold(robot)
    with pytest.raises(InputError, match=r"line_sensor\.threshold"):
        require_threshold(with_line_sensor(robot, threshold=0.9))
