"""The firmware itself on the simulated board, in lock-step and with what may befall a board."""

import contextlib

import pytest

from hil.build import build_firmware
from hil.errors import BoardLost
from hil.frames import SensorFrame
from hil.framings import FRAMINGS
from hil.links.lockstep import LockstepLink
from hil.loop import BoardLoop, LoopSettings

pytestmark = pytest.mark.board


@pytest.fixture
def loop(nominal, programs, board_program):
    with contextlib.ExitStack() as stack:

        def make(framing=FRAMINGS["framed"], **settings):
            build = build_firmware(nominal, framing.name, framing.baud, programs)
            link = LockstepLink(build.elf, framing.baud, program=board_program)
            stack.callback(link.close)
            made = BoardLoop.for_robot(link, framing, nominal, LoopSettings(delay_ticks=0, **settings))
            hello = made.start()
            assert hello is None or hello.firmware_id == build.id
            return made

        yield make


def on_the_line(loop, ticks):
    """Drives along a line that swings under the sensor, between nothing."""
    actuations = []
    for tick in range(ticks):
        line = [1.0] * 8
        line[3 + tick // 4 % 2] = 0.1
        actuations.append(loop.step(SensorFrame((20, 20), tuple(line), 2.0, 2.0, 2.0)))
    return actuations


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
def test_the_firmware_steers_to_the_line(loop, nominal, framing):
    """V = K1 - K3 |e| and w = K2 e with e = -0.5 and 0.5 of the two middle channels (paper Eq. 6-7)."""
    driven = loop(framing)
    gains = nominal.controller.line
    for actuation, error in zip(on_the_line(driven, 8), [-0.5] * 4 + [0.5] * 4, strict=True):
        assert actuation.v_m_s == pytest.approx(gains.k1_m_s - 0.5 * gains.k3_m_s, abs=1e-3)
        assert actuation.w_rad_s == pytest.approx(gains.k2_rad_s * error, abs=1e-2)
    assert driven.events == []
    assert driven.link.overrun == 0


def test_two_drives_are_the_same_to_the_cycle(loop):
    def drive():
        driven = loop()
        return [(actuation, driven.link.arrivals, driven.link.cycle) for actuation in on_the_line(driven, 10)]

    assert drive() == drive()


def test_a_reset_board_is_noticed(loop):
    driven = loop()
    on_the_line(driven, 4)
    driven.link.reset()
    # The frame of the tick in which it boots is lost, or answered with a count from 1.
    with pytest.raises(BoardLost, match=r"^the board re-booted at 0\.2[05] s; the robot was stopped$"):
        on_the_line(driven, 2)


def test_the_board_counts_what_it_could_not_read(loop):
    driven = loop()
    on_the_line(driven, 1)
    driven.link.write(b"\0noise\0more\0")
    on_the_line(driven, 1)
    assert [(event.kind, event.text) for event in driven.events] == [("damaged at the board", "2 frames")]
