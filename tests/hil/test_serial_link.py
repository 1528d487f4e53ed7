"""A serial port played by a pty pair, with a stand-in board or nobody at its other end."""

import contextlib
import errno
import os
import sys
import threading
import time
import tty

import pytest
import serial

from hil.errors import BoardLost
from hil.framings.framed import Framed
from hil.links import serial_link
from hil.links.serial_link import SerialLink
from hil.loop import BoardLoop, LoopSettings
from symolo.core.errors import EnvironmentLacking, InputError
from tests.hil.stand_in_board import StandInBoard


@pytest.fixture
def pty():
    board, port = os.openpty()
    tty.setraw(port)
    with contextlib.ExitStack() as stack:
        stack.callback(lambda: [close(end) for end in (board, port)])
        yield board, os.ttyname(port)


def close(descriptor):
    with contextlib.suppress(OSError):
        os.close(descriptor)


def test_a_board_at_a_port_drives(pty, limits, command, seen):
    end, port = pty
    board = StandInBoard(Framed(), lambda _sensors: command(0.1))
    stopped = threading.Event()

    def answer():
        while not stopped.is_set():
            board.write(os.read(end, 100))
            os.write(end, board.read() or b"\0")

    thread = threading.Thread(target=answer, daemon=True)
    thread.start()
    link = SerialLink(port, 500_000, answer_within=1.0)
    loop = BoardLoop(link, Framed(), limits, LoopSettings(tick_s=0.02, timeout_ticks=50))
    loop.start()
    began = time.monotonic()
    actuations = [loop.step(seen()) for _ in range(6)]
    assert time.monotonic() - began >= 5 * 0.02
    assert round(actuations[-1].v_m_s, 3) == 0.1
    stopped.set()
    loop.close()


class Clock:
    """Time that passes by sleeping and by waiting for a board that says nothing."""

    def __init__(self):
        self.now_s = 100.0
        self.waited_s = []

    def monotonic(self):
        return self.now_s

    def sleep(self, seconds):
        self.now_s += seconds

    def select(self, _read, _write, _error, seconds):
        self.waited_s.append(seconds)
        self.sleep(seconds)
        return [], [], []


@pytest.fixture
def timed(pty, monkeypatch):
    link = SerialLink(pty[1], 500_000)
    clock = Clock()
    monkeypatch.setattr(serial_link, "time", clock)
    monkeypatch.setattr(serial_link, "select", clock)
    with contextlib.closing(link):
        yield link, clock


def test_ticks_begin_at_equal_distances(timed):
    link, clock = timed
    began = []
    for busy_s in (0.01, 0.04, 0.0, 0.06, 0.01, 0.0):
        link.start_tick(0.05)
        began.append(clock.now_s)
        clock.sleep(busy_s)
    # One that is busy for longer than a tick makes the next one late, and those after it are on time again.
    assert began == pytest.approx([100.0, 100.05, 100.10, 100.15, 100.21, 100.25])


def test_a_tick_that_begins_late_says_so_and_one_late_by_a_tick_moves_those_after_it(timed):
    link, clock = timed
    link.start_tick(0.05)
    clock.sleep(0.08)
    assert link.start_tick(0.05) == pytest.approx(0.03)
    clock.sleep(0.12)
    assert link.start_tick(0.05) == pytest.approx(0.10)
    assert link.start_tick(0.05) == pytest.approx(0.0)
    assert clock.now_s == pytest.approx(100.25)


@pytest.mark.parametrize("late_s", [0.0, 0.04])
def test_an_answer_is_waited_for_until_half_a_tick_is_over_also_when_it_begins_late(timed, late_s):
    link, clock = timed
    link.start_tick(0.05)
    clock.sleep(0.05 + late_s)
    link.start_tick(0.05)
    assert link.read() == b""
    assert clock.waited_s == pytest.approx([0.025])


@pytest.mark.parametrize("what", ["write", "read"])
def test_a_port_that_goes_away_is_reported(pty, what):
    end, port = pty
    link = SerialLink(port, 500_000)
    with contextlib.closing(link):
        link.start_tick(1.0)
        os.close(end)
        with pytest.raises(BoardLost, match=f"^the board at {port} is gone: "):
            link.write(b"a") if what == "write" else link.read()


def test_a_port_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match=f"^--port {tmp_path}/ttyACM0: there is no such port; `ls /dev/ttyACM"):
        SerialLink(str(tmp_path / "ttyACM0"), 500_000)


def test_a_port_that_somebody_has_is_refused(pty):
    link = SerialLink(pty[1], 500_000)
    with contextlib.closing(link), pytest.raises(InputError, match=r"another program has the port; close its"):
        SerialLink(pty[1], 500_000)


def test_what_is_no_port_is_refused(tmp_path):
    file = tmp_path / "file"
    file.touch()
    for path in (file, tmp_path):
        with pytest.raises(InputError, match="this is no serial port; name one, such as /dev/ttyACM0"):
            SerialLink(str(path), 500_000)


def test_a_port_that_is_not_permitted_is_refused(monkeypatch):
    """Root, who may run the tests, is permitted everything."""

    def denied(*_arguments, **_options):
        raise serial.SerialException(errno.EACCES, "could not open port: Permission denied")

    monkeypatch.setattr(serial, "Serial", denied)
    with pytest.raises(InputError, match="you may not open the port; run `usermod -a -G dialout USER`"):
        SerialLink("/dev/ttyACM0", 500_000)


def test_without_pyserial_the_line_that_installs_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(
        EnvironmentLacking, match="needs pyserial, which is not installed; install symolo with the extra `generate`"
    ):
        SerialLink("/dev/ttyACM0", 500_000)
