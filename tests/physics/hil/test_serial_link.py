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

from configs.errors import EnvironmentLacking, InputError
from physics.hil.errors import BoardLost
from physics.hil.framings.framed import Framed
from physics.hil.links.serial_link import SerialLink
from physics.hil.links.stand_in import StandInBoard
from physics.hil.loop import BoardPilot, LoopSettings


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
    link = SerialLink(port, 500_000)
    pilot = BoardPilot(link, Framed(), limits, LoopSettings(tick_s=0.02))
    pilot.start()
    began = time.monotonic()
    orders = [pilot.step(seen()) for _ in range(6)]
    assert time.monotonic() - began >= 5 * 0.02
    assert [round(order.v_m_s, 3) for order in orders[1:]] == [0.1] * 5
    stopped.set()
    pilot.close()


def test_a_tick_that_begins_late_says_so_and_moves_the_next(pty):
    link = SerialLink(pty[1], 500_000)
    with contextlib.closing(link):
        assert link.start_tick(0.01) < 0.01
        time.sleep(0.05)
        assert link.start_tick(0.01) == pytest.approx(0.04, abs=0.02)
        assert link.start_tick(0.01) < 0.01


def test_a_silent_board_is_waited_for_until_half_of_the_tick(pty):
    link = SerialLink(pty[1], 500_000)
    with contextlib.closing(link):
        link.start_tick(0.1)
        began = time.monotonic()
        assert link.read() == b""
        assert time.monotonic() - began == pytest.approx(0.05, abs=0.03)


def test_an_answer_is_waited_for_as_long_in_a_tick_that_begins_late(pty):
    link = SerialLink(pty[1], 500_000)
    with contextlib.closing(link):
        link.start_tick(0.1)
        time.sleep(0.17)
        assert link.start_tick(0.1) == pytest.approx(0.07, abs=0.02)
        began = time.monotonic()
        link.read()
        assert time.monotonic() - began == pytest.approx(0.05, abs=0.03)


@pytest.mark.parametrize("what", ["write", "read"])
def test_a_port_that_goes_away_is_told_of(pty, what):
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
        with pytest.raises(InputError, match="this is no serial port; give one such as /dev/ttyACM0"):
            SerialLink(str(path), 500_000)


def test_a_port_that_is_not_permitted_is_refused(monkeypatch):
    """Root, who may run the tests, is permitted everything."""

    def denied(*_arguments, **_options):
        raise serial.SerialException(errno.EACCES, "could not open port: Permission denied")

    monkeypatch.setattr(serial, "Serial", denied)
    with pytest.raises(InputError, match="no right to open the port; `usermod -a -G dialout USER`"):
        SerialLink("/dev/ttyACM0", 500_000)


def test_without_pyserial_the_line_that_installs_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(EnvironmentLacking, match="needs pyserial, which is not installed; run `"):
        SerialLink("/dev/ttyACM0", 500_000)
