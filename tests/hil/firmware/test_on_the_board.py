"""The firmware's own program on the simulated board, beside the same sources compiled for this machine."""

import numpy as np
import pytest

from hil.board.build import build_board
from hil.build import build_firmware
from hil.frames import SensorFrame
from hil.framings.framed import Framed
from hil.links.lockstep import LockstepLink

pytestmark = pytest.mark.board

TICK_CYCLES = 800_000
"""50 ms at 16 MHz."""
FRAMING = Framed()


@pytest.fixture
def link(robot, pytestconfig):
    folder = pytestconfig.cache.mkdir("firmware")
    build = build_firmware(robot, "framed", FRAMING.baud, folder)
    link = LockstepLink(build.elf, FRAMING.baud, program=build_board(folder))
    link.start_tick(0.05)
    link.read()  # in which it boots
    yield link
    link.close()


@pytest.mark.firmware
def test_the_board_commands_what_the_library_does_long_before_the_tick_ends(robot, library, random_drive, link):
    drive = random_drive(robot, 600, np.random.Generator(np.random.PCG64(23)))
    expected, decoder = library(robot).drive(drive), FRAMING.from_board()
    answers, answered_at = [], []
    for tick, (counts, line, ranges_mm) in enumerate(zip(drive.counts, drive.line, drive.ranges_mm, strict=True)):
        ranges_m = (range_mm / 1000 if range_mm < 65535 else None for range_mm in ranges_mm)
        frame = SensorFrame(counts, tuple(value / 255 for value in line), *ranges_m, start=tick == 0)
        link.start_tick(0.05)
        link.write(FRAMING.sensors(tick & 0xFF, frame))
        (answer,) = decoder.decode(link.read())
        answers.append((answer.command.state, answer.command.v_m_s, answer.command.w_rad_s, answer.command.line_lost))
        answered_at.append(link.arrivals[-1])
    assert link.overrun == 0
    state, v_m_s, w_rad_s, line_lost = np.array(answers).T
    np.testing.assert_array_equal(state, expected.state)
    np.testing.assert_array_equal(line_lost, expected.line_lost)
    # Half a thousandth is the wire's; where a path's goal is one point off, see test_controller.
    apart = np.abs(np.stack([v_m_s, w_rad_s], axis=1) - expected.motion)
    assert np.mean(apart.max(axis=1) <= 0.00051) > 0.98
    assert max(answered_at) < 0.2 * TICK_CYCLES
