"""A line that flips, loses, adds, repeats and reorders: nothing wrong is obeyed, and the next whole frame is heard.

The full form, a million damaged frames each way, has the marker `faults`.
"""

import importlib

import numpy as np
import pytest

from hil.framings import FRAMINGS
from hil.framings.base import CommandMessage, SensorsMessage
from hil.plausibility import DriveLimits

REPEATS = {"the one before again", "an older one"}
"""Whole frames: a board, which does not look at numbers, hears them; on a serial line no frame overtakes another."""
SIZES = [20, pytest.param(72_000, marks=pytest.mark.faults)]


@pytest.fixture
def line_faults():
    return importlib.import_module("line_faults")


def drawn(*key):
    return np.random.Generator(np.random.PCG64(key))


@pytest.mark.parametrize("count", SIZES)
def test_no_damaged_command_is_obeyed(line_faults, nominal, count):
    limits = DriveLimits.from_robot(nominal)
    for index, kind in enumerate(line_faults.KINDS):
        tally = line_faults.to_simulator(FRAMINGS["framed"], kind, count, limits, drawn(1, index))
        assert (kind, tally.damaged, tally.obeyed) == (kind, count, 0)
        assert (kind, tally.first_lost, tally.second_lost) == (kind, 0, 0)


@pytest.mark.parametrize("count", SIZES)
def test_no_damaged_sensor_frame_is_taken_for_good(line_faults, count):
    for index, kind in enumerate(line_faults.KINDS):
        tally = line_faults.to_board(FRAMINGS["framed"], kind, count, drawn(2, index))
        assert (kind, tally.damaged) == (kind, count)
        assert kind in REPEATS or tally.passed == 0
        assert (kind, tally.first_lost, tally.second_lost) == (kind, 0, 0)


@pytest.mark.parametrize("count", [20_000, pytest.param(1_000_000, marks=pytest.mark.faults)])
@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
def test_of_noise_nothing_is_heard(framing, count):
    noise = drawn(3).bytes(count)
    for decoder in (framing.from_board(), framing.to_board()):
        heard = [found for at in range(0, count, 777) for found in decoder.decode(noise[at : at + 777])]
        assert heard
        assert not any(isinstance(found, CommandMessage | SensorsMessage) for found in heard)


def test_simtwo_takes_a_flipped_digit_for_good(line_faults, nominal):
    """Those bits that turn a digit into another digit: no framing finds what it has no means to see."""
    tally = line_faults.to_simulator(FRAMINGS["simtwo"], "1 bit", 300, DriveLimits.from_robot(nominal), drawn(4))
    assert 0.15 < tally.passed / tally.damaged < 0.35
    assert tally.obeyed < tally.passed
