"""What the firmware makes of the bytes that come in, by the framings in Python, which were written apart from it."""

import struct
from dataclasses import replace

import numpy as np
import pytest

from hil.build import BAUDS, firmware_sources
from hil.frames import SensorFrame
from hil.framings.base import CommandMessage
from hil.framings.framed import Framed
from hil.framings.simtwo import SimTwo
from symolo.dataset.codes import State

pytestmark = pytest.mark.compiler

ON_LINE = SensorFrame((100, 100), (0.9, 0.9, 0.9, 0.1, 0.1, 0.9, 0.9, 0.9), 2.0, 2.0, 2.0)
LEFT = replace(ON_LINE, line=(0.9,) * 6 + (0.1, 0.1))
WALL = replace(ON_LINE, line=(0.9,) * 8, right_m=0.3)
FRAMINGS = {"framed": Framed(), "simtwo": SimTwo()}


@pytest.fixture(params=FRAMINGS)
def framing(request):
    return FRAMINGS[request.param]


@pytest.fixture
def board(robot, library, framing):
    board = library(robot, framing.name)
    board.begin()
    return board


@pytest.fixture
def ask(board, framing):
    """Tells the board of a tick, 50 ms after the last one, and returns its commands."""

    def commands(frame, seq=1, after_ms=50, noise=b""):
        found = framing.from_board().decode(board.exchange(noise + framing.sensors(seq, frame), after_ms))
        assert all(isinstance(answer, CommandMessage) for answer in found)
        assert [answer.seq for answer in found] in ([], [seq if framing.numbers_frames else None])
        return [answer.command for answer in found]

    return commands


def test_a_line_to_the_left_turns_the_robot_left_by_the_paper_s_law(robot, ask):
    gains, drive = robot.controller.line, robot.drive
    v, w = gains.k1_m_s - 3.0 * gains.k3_m_s, 3.0 * gains.k2_rad_s  # channels 6 and 7: +2.5 and +3.5
    (command,) = ask(LEFT)
    assert command.state is State.LINE
    radius_m, half_m = 0.5 * drive.wheel_diameter_m, 0.5 * drive.track_m
    assert command.right_rad_s == pytest.approx((v + half_m * w) / radius_m, abs=0.0006)
    assert command.left_rad_s == pytest.approx((v - half_m * w) / radius_m, abs=0.0006)
    if command.v_m_s is not None:
        assert (command.v_m_s, command.w_rad_s) == pytest.approx((v, w), abs=0.0006)


def test_commanded_to_stand_still_it_does_and_keeps_its_state(ask, board):
    ask(ON_LINE)
    assert ask(WALL)[0].state is State.RIGHT_WALL
    (standing,) = ask(replace(LEFT, run=False))
    assert standing.state is State.RIGHT_WALL
    assert (standing.right_rad_s, standing.left_rad_s) == (0.0, 0.0)
    assert board.set_points() == (0.0, 0.0)


def test_a_start_begins_again(ask):
    ask(ON_LINE)
    assert ask(WALL)[0].state is State.RIGHT_WALL
    assert ask(replace(WALL, line=LEFT.line, start=True))[0].state is State.LINE
    assert ask(replace(WALL, right_m=2.0))[0].state is State.LINE


def test_the_start_holds_for_one_tick(ask):
    ask(replace(ON_LINE, start=True))
    assert [ask(WALL)[0].state for _ in range(2)] == [State.RIGHT_WALL] * 2


def test_after_150_ms_of_silence_the_wheels_are_stopped(ask, board, framing):
    (command,) = ask(LEFT)
    board.exchange(b"", 149)
    assert board.set_points() == pytest.approx((command.right_rad_s, command.left_rad_s), abs=0.001)
    board.exchange(framing.sensors(9, LEFT)[:-3], 1)
    assert board.set_points() == (0.0, 0.0)
    assert len(ask(LEFT)) == 1
    assert board.set_points() != (0.0, 0.0)


def test_one_good_frame_is_understood_after_any_noise(ask):
    rng = np.random.Generator(np.random.PCG64(3))
    for length in rng.integers(0, 60, 300):
        assert len(ask(ON_LINE, noise=rng.bytes(length))) == 1


def test_bytes_may_come_one_at_a_time(board, framing):
    heard = b"".join(board.exchange(bytes([byte])) for byte in framing.sensors(7, ON_LINE))
    assert len(framing.from_board().decode(heard)) == 1


@pytest.fixture
def framed(robot, library):
    board = library(robot)
    board.begin()
    return board


def commands(answer):
    return Framed().from_board().decode(answer)


def test_it_says_who_it_is(robot, framed):
    (hello,) = commands(framed.exchange(Framed().hello(200)))
    _, identity = firmware_sources(robot, "framed", BAUDS[0])
    assert (hello.protocol, hello.firmware_id, hello.baud_index) == (1, identity, 0)


def test_a_damaged_frame_is_dropped_and_reported_once(framed):
    good = Framed().sensors(5, ON_LINE)
    for place in range(1, len(good) - 1):
        damaged = bytearray(good)
        damaged[place] ^= 0x40
        assert framed.exchange(bytes(damaged)) == b""
    answers = [commands(framed.exchange(Framed().sensors(seq, ON_LINE)))[0].command for seq in (6, 7)]
    assert [command.dropped for command in answers] == [len(good) - 2, 0]
    assert [command.ticks for command in answers] == [1, 2]


def test_of_200000_random_bytes_it_accepts_nothing(framed):
    rng = np.random.Generator(np.random.PCG64(11))
    for _ in range(20):
        noise = rng.bytes(10_000)
        # Zeros end frames; more of them make more frames to try.
        assert framed.exchange(noise.replace(b"\x55", b"\0")) == b""


def test_lost_ticks_on_the_line_are_counted(framed):
    white = replace(ON_LINE, line=(0.9,) * 8)
    ticks = [commands(framed.exchange(Framed().sensors(seq, white)))[0].command.line_lost for seq in range(3)]
    assert ticks == [1, 2, 3]


def test_the_bytes_of_an_answer_are_those_of_the_format(framed):
    """Type, sequence, fields and CRC-16/IBM-3740, little endian, laid out by hand; COBS undone by its definition."""
    answer = framed.exchange(Framed().sensors(0x2A, replace(ON_LINE, run=False, start=True)))
    *stuffed, end = answer.strip(b"\0") + b"\0"
    body, at = bytearray(), 0
    while at < len(stuffed):
        code = stuffed[at]
        body += bytes(stuffed[at + 1 : at + code]) + (b"\0" if at + code < len(stuffed) else b"")
        at += code
    assert end == 0
    crc = 0xFFFF
    for byte in body[:-2]:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021) & 0xFFFF if crc & 0x8000 else crc << 1
    assert body == struct.pack("<BBBhhhhHHBH", ord("C"), 0x2A, 0, 0, 0, 0, 0, 0, 1, 0, crc)


def test_simtwo_frames_with_a_bad_character_are_dropped(robot, library):
    board = library(robot, "simtwo")
    board.begin()
    good = SimTwo().sensors(0, LEFT)
    assert good[-9:] == b"G00000001"
    for bad in (b"G0000000g", b"G0000000 ", b"G00000a01", b"G0000001"):
        assert board.exchange(good[:-9] + bad) == b""
    assert board.exchange(b"G00000001").startswith(b"s00000000M")
