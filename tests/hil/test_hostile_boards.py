"""Boards behind a pty that flood, lie, answer slowly or go away: a message ends each, in bounded time and memory."""

import contextlib
import os
import threading
import time
import tracemalloc
import tty
from dataclasses import replace

import pytest

from hil.errors import BoardLost
from hil.framings import FRAMINGS
from hil.framings.base import SensorsMessage
from hil.framings.framed import Framed
from hil.links.serial_link import SerialLink
from hil.loop import BoardLoop, LoopSettings
from tests.hil.stand_in_board import StandInBoard

TICK_S = 0.02
GIVE_UP_S = 0.2
SETTINGS = LoopSettings(tick_s=TICK_S, timeout_ticks=3, give_up_s=GIVE_UP_S, hello_s=0.2)
PATIENCE_S = 3.0
"""Longer than greeting, silence and a blocked write together; whoever does not come back by then hangs."""
BYTES = 20_000_000


@pytest.fixture
def behind_a_pty():
    """Runs a function of the board's end of a pty in a thread until it returns or its end is closed."""
    with contextlib.ExitStack() as stack:

        def start(board):
            end, port = os.openpty()
            tty.setraw(port)
            stopped = threading.Event()

            def run():
                with contextlib.suppress(OSError):
                    board(end, stopped)

            thread = threading.Thread(target=run, daemon=True)

            def close():
                stopped.set()
                with contextlib.suppress(OSError):
                    os.set_blocking(end, False)
                while thread.is_alive():  # it may wait for bytes, or for room in a line that nobody reads
                    for wake in (lambda: os.write(port, b"\0"), lambda: os.read(port, 1 << 16)):
                        with contextlib.suppress(OSError):
                            os.set_blocking(port, False)
                            wake()
                    thread.join(0.01)
                for descriptor in (end, port):
                    with contextlib.suppress(OSError):
                        os.close(descriptor)

            stack.callback(close)
            thread.start()
            return os.ttyname(port)

        yield start


def flood(piece):
    """A board that sends the same bytes over and over, as fast as the line takes them."""

    def board(end, stopped):
        while not stopped.is_set():
            os.write(end, piece)

    return board


def obedient(framing, controller, spoil=lambda said: said, pause_s=0.0):
    """A board with the firmware, of which every answer is changed, and sent a byte at a time where there is a pause."""

    def board(end, stopped):
        stand_in = StandInBoard(framing, controller)
        while not stopped.is_set():
            stand_in.write(os.read(end, 4096))
            said = stand_in.read()
            said = spoil(said) if said else said
            step = 1 if pause_s else max(1, len(said))
            for at in range(0, len(said), step):
                if pause_s and stopped.wait(pause_s):
                    return
                os.write(end, said[at : at + step])

    return board


def ends(port, framing, limits, seen, ticks=100, settings=SETTINGS):
    """Drive with the board at a port, and return the loop and the error that ends it; both must come in time."""
    ended = []
    link = SerialLink(port, 500_000)
    loop = BoardLoop(link, framing, limits, settings)

    def drive():
        try:
            with loop:
                loop.start()
                for _ in range(ticks):
                    loop.step(seen())
        except BoardLost as error:
            ended.append(error)

    thread = threading.Thread(target=drive, daemon=True)
    tracemalloc.start()
    thread.start()
    thread.join(PATIENCE_S)
    used = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert not thread.is_alive(), "hangs"
    assert used < BYTES
    return loop, str(ended[0]) if ended else ""


JUNK = {
    "zeros": b"\0" * 4096,
    "letters": b"G" * 4096,
    "noise": bytes(range(1, 256)) * 16,
    "half frames": b"\0\3C\7" * 1024,
}


@pytest.mark.parametrize("junk", JUNK.values(), ids=JUNK)
@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
def test_a_board_that_floods_the_line_with_junk_is_given_up(framing, junk, behind_a_pty, limits, seen):
    _, why = ends(behind_a_pty(flood(junk)), framing, limits, seen)
    assert why.startswith("no answer from ")


def test_a_board_that_floods_with_old_answers_is_given_up(behind_a_pty, limits, command, seen):
    """They are whole frames, so each is one event of its tick, and all of a tick make one note."""
    framing = Framed()
    old = framing.command(200, replace(command(0.1), ticks=1, dropped=0)) * 100

    def board(end, stopped):
        stand_in = StandInBoard(framing, lambda _sensors: command(0.1))
        stand_in.write(os.read(end, 4096))
        os.write(end, stand_in.read())
        flood(old)(end, stopped)

    loop, why = ends(behind_a_pty(board), framing, limits, seen)
    assert f"for {GIVE_UP_S:g} s" in why
    assert "last: an answer to frame 200, the last is " in why
    stale = [event for event in loop.events if event.kind == "stale"]
    assert len(stale) == len({event.tick for event in stale}) <= 11
    assert sum(event.count for event in stale) > 100


def test_a_board_that_answers_each_frame_and_floods_beside_is_driven_with_within_the_memory(
    behind_a_pty, limits, command, seen
):
    framing = Framed()
    answered = threading.Event()

    def beside(said):
        answered.set()
        return said + said * 100

    loop, why = ends(
        behind_a_pty(obedient(framing, lambda _sensors: command(0.1), beside)), framing, limits, seen, ticks=20
    )
    assert answered.is_set()
    assert why == ""
    assert max(len([event for event in loop.events if event.tick == tick]) for tick in range(20)) < 8


@pytest.mark.parametrize(
    ("lie", "why"),
    [
        ({"right_rad_s": 30.0, "left_rad_s": 30.0, "v_m_s": 1.5, "w_rad_s": 0.0}, "the wheels reach 20.0"),
        ({"right_rad_s": -4.0}, "do not fit"),
        ({"v_m_s": 0.5}, "do not fit"),
    ],
)
def test_a_board_that_lies_is_given_up_and_its_lie_is_named(lie, why, behind_a_pty, limits, command, seen):
    board = obedient(Framed(), lambda _sensors: replace(command(0.1), **lie))
    loop, ended = ends(behind_a_pty(board), Framed(), limits, seen)
    assert "the robot was stopped; last: " in ended
    assert why in ended
    assert {event.kind for event in loop.events} >= {"refused", "stopped"}


def test_a_board_whose_checksums_are_wrong_is_given_up(behind_a_pty, limits, command, seen):
    """From its first answer to readings on; the greeting is fine."""
    hello = []

    def spoil(said):
        hello.append(said)
        return said if len(hello) == 1 else said[:5] + bytes([said[5] ^ 1]) + said[6:]

    _, why = ends(behind_a_pty(obedient(Framed(), lambda _sensors: command(0.1), spoil)), Framed(), limits, seen)
    assert "last: 1 from the board: wrong checksum" in why


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
def test_a_board_each_of_whose_bytes_is_late_is_given_up(framing, behind_a_pty, limits, command, seen):
    """An answer of 20 bytes takes ten ticks, so each answers readings that are long past."""
    began = time.monotonic()
    board = obedient(framing, lambda _sensors: command(0.1), pause_s=0.5 * TICK_S)
    _, why = ends(behind_a_pty(board), framing, limits, seen, settings=replace(SETTINGS, hello_s=0.5))
    assert why.startswith(("no answer from", "no command from"))
    assert time.monotonic() - began < PATIENCE_S


@pytest.mark.parametrize("after", [1, 5])
def test_a_board_that_goes_away_is_reported_gone(after, behind_a_pty, limits, command, seen):
    def board(end, stopped):
        stand_in = StandInBoard(Framed(), lambda _sensors: command(0.1))
        frames = 0
        decoder = Framed().to_board()
        while not stopped.is_set():
            data = os.read(end, 4096)
            frames += sum(isinstance(message, SensorsMessage) for message in decoder.decode(data))
            if frames >= after:
                os.close(end)
                return
            stand_in.write(data)
            os.write(end, stand_in.read() or b"\0")

    port = behind_a_pty(board)
    loop, why = ends(port, Framed(), limits, seen)
    assert why.startswith(f"the board at {port} is gone: ")
    assert loop._closed


def test_a_board_that_reads_nothing_is_given_up(behind_a_pty, limits, seen):
    """What it does not read fills the line, and whoever writes would wait for ever."""
    settings = replace(SETTINGS, tick_s=0.001, hello_s=1.0)
    _, why = ends(behind_a_pty(lambda _end, stopped: stopped.wait()), Framed(), limits, seen, settings=settings)
    assert why.startswith(("no answer from ", "the board at "))
