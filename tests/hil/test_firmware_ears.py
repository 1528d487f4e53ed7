"""The firmware's ears beside those in Python, two programs after one description, on the same bad line."""

import importlib

import numpy as np
import pytest

from hil.framings import FRAMINGS

pytestmark = pytest.mark.compiler


@pytest.mark.parametrize("count", [20, pytest.param(72_000, marks=pytest.mark.faults)])
def test_both_hear_the_same_frames_on_a_bad_line(nominal, programs, count):
    both = importlib.import_module("firmware_line_faults")
    firmware = both.NativeFirmware(nominal, FRAMINGS["framed"], programs)
    draw = np.random.Generator(np.random.PCG64(5))
    for kind in both.KINDS:
        pieces = both.damaged_stream(FRAMINGS["framed"], kind, count, draw)
        assert (kind, both.disagreements(firmware, FRAMINGS["framed"], pieces)) == (kind, 0)
    noise = draw.bytes(14 * count)
    assert (
        both.disagreements(firmware, FRAMINGS["framed"], [noise[at : at + 99] for at in range(0, len(noise), 99)]) == 0
    )
