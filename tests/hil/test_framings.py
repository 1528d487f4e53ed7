"""Framings against frames written by hand, and against whatever may come over a line."""

import binascii
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.frames import CommandFrame, HelloFrame, SensorFrame
from hil.framings import FRAMINGS
from hil.framings.base import CommandMessage, Damaged, HelloRequest, SensorsMessage
from hil.framings.cobs import stuffed, unstuffed
from hil.framings.framed import Framed, crc16
from hil.framings.simtwo import SimTwo
from symolo.dataset.codes import State

MILLI = st.integers(-32768, 32767).map(lambda number: number / 1000.0)
RANGE = st.none() | st.integers(0, 65534).map(lambda mm: mm / 1000.0)
INCREMENT = st.integers(-32767, 32767)
SENSORS = st.builds(
    SensorFrame,
    st.tuples(INCREMENT, INCREMENT),
    st.tuples(*[st.integers(0, 255).map(lambda level: level / 255.0)] * 8),
    RANGE,
    RANGE,
    RANGE,
    st.booleans(),
    st.booleans(),
)
WORD = st.integers(0, 65535)
COMMANDS = st.builds(CommandFrame, st.sampled_from(State), MILLI, MILLI, MILLI, MILLI, WORD, WORD, st.integers(0, 255))
NOISE = st.binary(max_size=80)

SEEN = SensorFrame((1, -2), (0.0, 1.0, 0.2, 0.4, 0.6, 0.8, 1.0, 0.0), 0.258, 2.0, None, run=True, start=True)
TOLD = CommandFrame(State.LOST_LEFT_WALL, 8.192, -1.0, 0.25, -0.001, 3, 258, 5)


def check(data):
    """CRC-16/IBM-3740 bit by bit."""
    crc = 0xFFFF
    for byte in data:
        for bit in range(8):
            out = crc >> 15 ^ byte >> (7 - bit) & 1
            crc = crc << 1 & 0xFFFF ^ (0x1021 if out else 0)
    return crc


def test_the_checksum_is_the_one_of_the_catalogue():
    """The check value of CRC-16/IBM-3740 in the catalogue of parametrised CRC algorithms."""
    assert crc16(b"123456789") == check(b"123456789") == 0x29B1


@pytest.mark.parametrize(
    ("plain", "on_the_wire"),
    [
        ("", "01"),
        ("00", "01 01"),
        ("00 00", "01 01 01"),
        ("11 22 00 33", "03 11 22 02 33"),
        ("11 22 33 44", "05 11 22 33 44"),
        ("11 00 00 00", "02 11 01 01 01"),
    ],
)
def test_bytes_are_stuffed_as_in_published_examples(plain, on_the_wire):
    assert stuffed(bytes.fromhex(plain)) == bytes.fromhex(on_the_wire)
    assert unstuffed(bytes.fromhex(on_the_wire)) == bytes.fromhex(plain)


@settings(max_examples=25, deadline=None)
@given(st.binary(max_size=600))
def test_stuffed_bytes_hold_no_zero_and_come_back(data):
    assert 0 not in stuffed(data)
    assert unstuffed(stuffed(data)) == data


def framed_by_hand(body):
    data = bytes.fromhex(body)
    whole = data + check(data).to_bytes(2, "little")
    parts = whole.split(b"\0")
    return b"\0" + b"".join(bytes([len(part) + 1]) + part for part in parts) + b"\0"


def test_a_sensor_frame_is_laid_out_as_written_down():
    """Flags, increments, line, front 258 mm, left 2000 mm, right missing.

    Number and payload after the flags add up to 0x8FC, whose last six bits stand above run and start.
    """
    by_hand = framed_by_hand("53 2A  F3 0100 FEFF  00 FF 33 66 99 CC FF 00  0201 D007 FFFF")
    assert Framed().sensors(0x2A, SEEN) == by_hand


def test_a_sensor_frame_that_does_not_add_up_is_dropped_though_its_checksum_is_right():
    by_hand = framed_by_hand("53 2A  03 0100 FEFF  00 FF 33 66 99 CC FF 00  0201 D007 FFFF")
    assert Framed().to_board().decode(by_hand) == [Damaged("sensors that do not add up")]


def test_a_command_frame_is_laid_out_as_written_down():
    by_hand = framed_by_hand("43 2A  21 0020 18FC FA00 FFFF 0300 0201 05")
    assert Framed().from_board().decode(by_hand) == [CommandMessage(TOLD, 0x2A)]
    assert Framed().command(0x2A, TOLD) == by_hand


def test_a_hello_is_laid_out_as_written_down():
    asked, answered = framed_by_hand("48 07"), framed_by_hand("68 07 01 0011223344556677 02")
    who = HelloFrame(1, "0011223344556677", 2)
    assert Framed().hello(7) == asked
    assert Framed().hello_answer(7, who) == answered
    assert Framed().from_board().decode(answered) == [who]
    assert Framed().to_board().decode(asked) == [HelloRequest(7)]


def test_simtwo_frames_are_laid_out_as_written_down():
    assert SimTwo().sensors(9, SEEN) == b"R0001FFFEI00FF3366J99CCFF00H010207D0KFFFF0000G00000003"
    assert SimTwo().command(9, TOLD) == b"s00000021M00002000QFFFFFC18"
    messages = SimTwo().from_board().decode(b"s00000021M00002000QFFFFFC18")
    assert messages == [CommandMessage(CommandFrame(State.LOST_LEFT_WALL, 8.192, -1.0), None)]


def in_pieces(decoder, data, cuts):
    places = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    return [found for begin, end in pairwise(places) for found in decoder.decode(data[begin:end])]


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
@settings(max_examples=25, deadline=None)
@given(frame=SENSORS, seq=st.integers(0, 255), cuts=st.lists(st.integers(0, 99), max_size=4))
def test_what_the_sensors_say_comes_to_the_board_in_pieces_of_any_length(framing, frame, seq, cuts):
    number = seq if framing.numbers_frames else None
    assert in_pieces(framing.to_board(), framing.sensors(seq, frame), cuts) == [SensorsMessage(frame, number)]


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
@settings(max_examples=25, deadline=None)
@given(frame=COMMANDS, seq=st.integers(0, 255), cuts=st.lists(st.integers(0, 99), max_size=4))
def test_a_command_comes_back_in_pieces_of_any_length(framing, frame, seq, cuts):
    expected = CommandMessage(frame, seq)
    if not framing.numbers_frames:
        expected = CommandMessage(CommandFrame(frame.state, frame.right_rad_s, frame.left_rad_s), None)
    assert in_pieces(framing.from_board(), framing.command(seq, frame), cuts) == [expected]


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
@settings(max_examples=25, deadline=None)
@given(noise=NOISE, frame=COMMANDS, seen=SENSORS)
def test_a_whole_frame_is_heard_whatever_came_before_it(framing, noise, frame, seen):
    heard = framing.from_board().decode(noise + framing.command(1, frame))
    assert [type(found) for found in heard][-1:] == [CommandMessage]
    heard = framing.to_board().decode(noise + framing.sensors(1, seen))
    assert heard[-1] == SensorsMessage(seen, 1 if framing.numbers_frames else None)


@settings(max_examples=25, deadline=None)
@given(data=st.binary(max_size=400), length=st.integers(0, 4))
def test_a_frame_of_a_wrong_length_or_type_is_dropped_though_its_checksum_is_right(data, length):
    for body in (data, b"C\1" + data[:length], b"X\1" + bytes(14), b"S\1" + bytes(19)):
        whole = stuffed(body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "little")) + b"\0"
        assert all(isinstance(found, Damaged) for found in Framed().from_board().decode(whole))


def test_a_state_that_there_is_not_is_damage():
    assert Framed().from_board().decode(framed_by_hand("43 01  07 0000 0000 0000 0000 0000 0100 00")) == [
        Damaged("there is no state 7")
    ]
    assert SimTwo().from_board().decode(b"s00000007M00000000Q00000000") == [Damaged("there is no state 7")]


@pytest.mark.parametrize(
    "bad", ["s0000000", "s00000000M0000000g", "s0000000aM0000000", "M00000000", "s00000000Q00000000"]
)
def test_simtwo_channels_that_are_cut_or_out_of_order_make_no_command(bad):
    decoder = SimTwo().from_board()
    assert not any(isinstance(found, CommandMessage) for found in decoder.decode(bad.encode() + b"Q00000000"))
    assert [type(found) for found in decoder.decode(b"s00000000M00000000Q00000000")] == [CommandMessage]


def test_what_does_not_fit_is_held_within_what_does():
    seen = SensorFrame((0, 0), (-0.5, 1.5, *[0.5] * 6), 70.0, -0.1, 0.1234)
    [asked] = Framed().to_board().decode(Framed().sensors(0, seen))
    assert asked.sensors.line[:2] == (0.0, 1.0)
    assert (asked.sensors.front_m, asked.sensors.left_m, asked.sensors.right_m) == (65.534, 0.0, 0.123)


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
def test_increments_and_channels_that_cannot_be_sent_are_refused(framing, seen):
    with pytest.raises(ValueError, match="encoder increments 40000, 0 do not fit in 16 bits"):
        framing.sensors(0, seen((40000, 0)))
    with pytest.raises(ValueError, match="a line sensor of 5 channels; the frame has 8"):
        framing.sensors(0, SensorFrame((0, 0), (1.0,) * 5, 1.0, 1.0, 1.0))
