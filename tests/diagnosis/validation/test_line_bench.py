"""The line bench against closed forms and the paper's Fig. 5."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from configs.schema.arena import Floor, LineConfig
from configs.schema.robot import RobotConfig
from diagnosis.validation.line_sensor.bench import check_line
from diagnosis.validation.line_sensor.channels import Spread, channels, converter
from diagnosis.validation.line_sensor.edge import crossings, edge_width_m
from diagnosis.validation.line_sensor.rig import Tape
from diagnosis.validation.line_sensor.threshold import threshold_bench
from symolo.core.errors import InputError

NOMINAL = Path(__file__).parents[3] / "configs" / "robots" / "nominal.yaml"
PITCH_M = 0.009525


@pytest.fixture(scope="module")
def robot():
    return RobotConfig.model_validate(yaml.safe_load(NOMINAL.read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def config(robot):
    return robot.line_sensor


def test_the_tape_is_that_of_an_arena_that_says_nothing_else():
    assert Tape() == Tape(LineConfig().width_m, LineConfig().reflectance, Floor().reflectance)


def test_every_channel_sees_the_edge_as_wide_as_its_spot_says(config):
    low, high = crossings(config, Tape(), seed=3)
    assert (low.height_m, high.height_m) == (0.003, 0.006)
    for found, diameter_m in ((low, 0.005), (high, 0.008)):
        # 10-90 % of a normal distribution is 2.5631 standard deviations; a disc's is a quarter of its diameter.
        expected_m = 2.5631 * 0.25 * diameter_m
        assert found.edge_closed_form_m == pytest.approx(expected_m, rel=1e-4)
        assert found.edge_10_90_m == pytest.approx([expected_m] * 8, rel=0.005)
        assert found.edges_are_apart


def test_channels_meet_the_tape_in_the_order_of_their_places(config):
    found = crossings(config, Tape(), seed=3)[0]
    offset, reading = np.array(found.offset_m), np.array(found.faultless)
    # A robot to the left of the tape by y has it under the channel that sits y to its right.
    middles = [float(offset[row < 0.45].mean()) for row in reading]
    assert middles == pytest.approx([PITCH_M * (3.5 - channel) for channel in range(8)], abs=1e-4)


def test_the_width_of_a_straight_slope_is_80_percent_of_it():
    offset = np.linspace(-0.02, 0.02, 4001)
    ink = np.clip((0.0075 - np.abs(offset)) / 0.003 + 0.5, 0.0, 1.0)
    assert edge_width_m(offset, 0.85 - 0.8 * ink, Tape()) == pytest.approx(0.8 * 0.003, abs=1e-6)


def test_channels_differ_as_configured(config):
    wide = config.model_copy(update={"gain_sd": 0.05, "offset_sd": 0.02})
    found = channels(wide, seed=7)
    for spread, mean, sd in ((found.gain, 1.0, 0.05), (found.offset, 0.0, 0.02)):
        assert len(spread.values) == 8 * found.robots
        assert spread.mean == pytest.approx(mean, abs=5 * sd / math.sqrt(len(spread.values)))
        assert spread.sd == pytest.approx(sd, abs=5 * spread.sd_error)
    assert found.gain.sd_error == pytest.approx(0.05 / math.sqrt(2 * 3999))


def test_equal_channels_have_no_spread(config):
    found = channels(config.model_copy(update={"gain_sd": 0.0, "offset_sd": 0.0}), seed=7)
    assert found.gain.sd < 1e-12
    assert found.gain.mean == pytest.approx(1.0, abs=1e-4)  # but for the finest converter's steps


def test_a_spread_is_that_of_a_sample():
    found = Spread.of(np.array([1.0, 2.0, 3.0, 4.0]), 1.2)
    assert (found.mean, found.sd) == (2.5, pytest.approx(math.sqrt(5.0 / 3.0)))
    assert found.sd_error == pytest.approx(1.2 / math.sqrt(6.0))


@pytest.mark.parametrize("bits", [1, 4, 10])
def test_a_converter_has_all_of_its_levels_in_equal_steps(config, bits):
    found = converter(config.model_copy(update={"adc_bits": bits}), seed=1)
    assert found.levels == 2**bits
    assert found.step == pytest.approx(1.0 / (2**bits - 1), rel=1e-9)
    assert found.largest_error == pytest.approx(0.5 / (2**bits - 1), rel=1e-6)


def test_the_threshold_behaves_as_in_figure_5(config):
    found = threshold_bench(config, Tape())
    aligned, right, left = found.cases
    assert (aligned.active, aligned.line_error) == ((3, 4), 0.0)
    assert right.offset_m < 0.0
    assert (right.active, right.line_error) == ((4,), 0.5)
    assert (left.active, left.line_error) == ((3,), -0.5)
    assert all(case.agrees for case in found.cases)


def test_figure_5_holds_from_one_to_two_pitches_of_tape(config):
    found = threshold_bench(config, Tape())
    # Half of the contrast is 0.45, the threshold, so that a channel is on with its middle over the tape.
    assert found.narrowest_tape_m == pytest.approx(PITCH_M, abs=1e-5)
    assert found.widest_tape_m == pytest.approx(2 * PITCH_M, abs=1e-5)


def test_a_lower_threshold_asks_for_more_tape(config):
    found = threshold_bench(config.model_copy(update={"threshold": 0.25}), Tape())
    # 0.25 is reached with 75 % of the spot on the tape: 0.6745 standard deviations inside its edge.
    inside_m = 0.6745 * 0.25 * 0.005
    assert found.narrowest_tape_m == pytest.approx(PITCH_M + 2 * inside_m, abs=2e-5)
    assert found.widest_tape_m == pytest.approx(2 * PITCH_M + 2 * inside_m, abs=2e-5)


def test_a_tape_that_is_too_wide_is_not_as_in_figure_5(config):
    found = threshold_bench(config, Tape(width_m=0.025))
    assert not all(case.agrees for case in found.cases)
    assert found.widest_tape_m is None


def test_a_threshold_that_never_tells_tape_from_floor_is_refused(robot):
    check_line(robot)
    blind = robot.line_sensor.model_copy(update={"threshold": 0.9})
    with pytest.raises(InputError, match=r"line_sensor\.threshold"):
        check_line(robot.model_copy(update={"line_sensor": blind}))
