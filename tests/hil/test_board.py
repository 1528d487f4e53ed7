"""The simulated board against the data sheet of the ATmega2560 and what a wire does."""

import contextlib
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from hil.board.build import build_board
from hil.errors import BoardLost
from hil.links.lockstep import LockstepLink
from hil.links.pty_board import PtyBoard
from symolo.core.errors import EnvironmentLacking

pytestmark = pytest.mark.board

TICK_S, TICK_CYCLES = 0.05, 800_000
BYTE = 10 * 16_000_000 // 500_000
"""Cycles of ten bits at 500 kBd and 16 MHz: 320."""


@pytest.fixture
def lockstep(board_program, obedient):
    with contextlib.ExitStack() as stack:

        def start(baud=500_000, firmware_baud=500_000):
            link = LockstepLink(obedient(firmware_baud), baud, program=board_program)
            stack.callback(link.close)
            said(link, b"")  # in which it boots
            return link

        yield start


def said(link, data):
    link.start_tick(TICK_S)
    link.write(data)
    return link.read()


def is_alive(pid):
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    return False


def wait_until(holds, seconds=5.0):
    until = time.monotonic() + seconds
    while not holds() and time.monotonic() < until:
        time.sleep(0.01)
    return holds()


def test_an_answer_takes_the_time_of_its_bytes_on_the_wire(lockstep):
    link = lockstep()
    assert said(link, b"hello") == b"ifmmp"
    # There, and back; between them the few instructions of an interrupt.
    assert 2 * BYTE < link.arrivals[0] < 2 * BYTE + 100
    assert np.allclose(np.diff(link.arrivals), BYTE, atol=2)


def test_ticks_are_800000_cycles_and_do_not_drift(lockstep):
    link = lockstep()
    arrivals = set()
    for _ in range(50):
        assert said(link, b"a") == b"b"
        arrivals.add(link.arrivals[0])
    assert link.cycle == 51 * TICK_CYCLES
    assert max(arrivals) - min(arrivals) <= 4


def test_what_is_not_read_in_its_tick_does_not_come_in_the_next(lockstep):
    link = lockstep()
    link.start_tick(TICK_S)
    link.write(b"ab")
    assert said(link, b"c") == b"d"
    assert link.cycle == 3 * TICK_CYCLES


def test_bytes_that_a_tick_ends_before_come_in_the_next(lockstep):
    """A tick has room for 2500 bytes; of what begins in it, the last two are not back yet at its end."""
    link = lockstep()
    first, second = said(link, b"a" * 3000), said(link, b"")
    assert first + second == b"b" * 3000
    assert len(first) in {2497, 2498}


def test_the_same_bytes_give_the_same_answers_at_the_same_cycles(lockstep):
    draw = np.random.Generator(np.random.PCG64(7))
    pieces = [bytes(byte for byte in draw.bytes(40) if byte not in b"xj") for _ in range(20)]

    def run():
        link = lockstep()
        return [(said(link, piece), link.arrivals, link.cycle, link.overrun) for piece in pieces]

    assert run() == run()


def test_a_reset_board_starts_afresh(lockstep):
    link = lockstep()
    assert said(link, b"nnn") == b"\1\2\3"
    link.reset()
    said(link, b"")
    assert said(link, b"n") == b"\1"


def test_a_byte_while_the_receiver_is_off_is_not_heard(board_program, obedient):
    link = LockstepLink(obedient(), 500_000, program=board_program)
    with contextlib.closing(link):
        assert said(link, b"a") == b""  # it boots for some microseconds
        assert link.unheard == 1


def test_a_firmware_that_reads_too_late_loses_what_the_buffer_cannot_hold(lockstep):
    """Two bytes wait in the buffer and one in the shift register (ATmega2560, section 22.7.1)."""
    link = lockstep()
    assert said(link, b"wabcdefgh") == b"bcd"
    assert link.overrun == 5


@pytest.mark.parametrize(
    ("baud", "firmware_baud", "heard"),
    [
        (115_200, 115_200, True),  # the nearest that 16 MHz give is 117647, 2.1 % off
        (250_000, 500_000, False),
        (500_000, 115_200, False),
    ],
)
def test_a_wrong_baud_rate_gives_wrong_bytes(lockstep, baud, firmware_baud, heard):
    assert (said(lockstep(baud, firmware_baud), b"UUU") == b"VVV") == heard


@pytest.mark.parametrize(("command", "why"), [(b"x", "sleeps with interrupts off"), (b"j", "crashed at address")])
def test_firmware_that_stops_is_reported(lockstep, command, why):
    link = lockstep()
    with pytest.raises(BoardLost, match=f"^the simulated board stopped: the firmware {why}.*cycle 8[0-9]*$"):
        said(link, command)


def test_a_board_that_is_killed_is_reported(lockstep):
    link = lockstep()
    os.kill(link.pid, signal.SIGKILL)
    with pytest.raises(BoardLost, match="ended with status -9"):
        said(link, b"a")


def test_what_is_no_firmware_is_refused(board_program, tmp_path):
    text = tmp_path / "firmware.elf"
    text.write_text("no firmware")
    link = LockstepLink(text, 500_000, program=board_program)
    with contextlib.closing(link), pytest.raises(BoardLost, match=r"firmware\.elf is no firmware"):
        said(link, b"")


def test_no_board_is_left_behind(board_program, obedient):
    link = LockstepLink(obedient(), 500_000, program=board_program)
    link.close()
    link.close()
    assert not is_alive(link.pid)


@pytest.mark.parametrize("mode", ["lockstep", "pty"])
def test_a_board_ends_when_its_owner_is_killed(board_program, obedient, mode):
    program = (
        "import subprocess, sys, time\n"
        "child = subprocess.Popen(sys.argv[1:], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,"
        " stderr=subprocess.DEVNULL)\n"
        "print(child.pid, flush=True)\n"
        "time.sleep(60)\n"
    )
    board = [board_program, mode, "atmega2560", "16000000", obedient(), "500000"]
    with subprocess.Popen([sys.executable, "-S", "-c", program, *board], stdout=subprocess.PIPE) as owner:
        pid = int(owner.stdout.readline())
        assert is_alive(pid)
        owner.kill()
    assert wait_until(lambda: not is_alive(pid))


def test_a_board_behind_a_pty_answers_in_real_time(board_program, obedient):
    with PtyBoard(obedient(), 500_000, program=board_program) as board:
        port = os.open(board.port, os.O_RDWR | os.O_NOCTTY)
        try:
            assert heard_at(port, b"hellon", 6) == b"ifmmp\6"
            board.reset()
            assert wait_until(lambda: b"" < heard_at(port, b"n", 1, 0.2) < b"\6")
        finally:
            os.close(port)
    assert not is_alive(board.pid)


def test_a_board_behind_a_pty_answers_no_sooner_than_a_wire_lets_it(board_program, obedient):
    """At 2400 baud a byte takes 4.2 ms, and its answer as long again, however long the board has slept before."""
    with PtyBoard(obedient(2400), 2400, program=board_program) as board:
        port = os.open(board.port, os.O_RDWR | os.O_NOCTTY)
        try:
            for _ in range(5):
                time.sleep(0.007)
                began = time.monotonic()
                assert heard_at(port, b"a", 1) == b"b"
                assert time.monotonic() - began > 0.99 * 2 * 10 / 2400
        finally:
            os.close(port)


def heard_at(port, data, length, patience_s=5.0):
    os.write(port, data)
    heard = b""
    while len(heard) < length and select.select([port], [], [], patience_s)[0]:
        heard += os.read(port, 100)
    return heard


def test_the_board_is_built_once(tmp_path):
    made = build_board(tmp_path / "cache")
    written = made.stat().st_mtime_ns
    assert build_board(tmp_path / "cache") == made
    assert made.stat().st_mtime_ns == written
    assert list(made.parent.iterdir()) == [made]


def test_without_a_compiler_the_line_that_installs_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(EnvironmentLacking, match=r"no C compiler; run `apt-get install -y gcc .*libsimavr-dev"):
        build_board(tmp_path / "cache")


@pytest.mark.parametrize(
    "said_by_gcc",
    [
        "board.c:30:10: fatal error: simavr/avr_uart.h: No such file or directory",
        "/usr/bin/ld: cannot find -lelf: No such file or directory",
    ],
)
def test_without_simavr_the_line_that_installs_it_is_named(tmp_path, monkeypatch, said_by_gcc):
    gcc = tmp_path / "gcc"
    gcc.write_text(f"#!/bin/sh\necho '{said_by_gcc}' >&2\nexit 1\n")
    gcc.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/bin")
    with pytest.raises(EnvironmentLacking, match=r"cannot be built: .*; run `apt-get install -y gcc .*libelf-dev`"):
        build_board(tmp_path / "cache")
