"""A drive whose numbers are easy, and a firmware that does what bytes tell it, on a simulated board."""

import importlib.util
import shutil
import subprocess
from pathlib import Path

import pytest

from physics.control.base import State
from physics.hil.board.build import build_board
from physics.hil.frames import CommandFrame, SensorFrame
from physics.hil.plausible import DriveLimits

HEADER = Path("/usr/include/simavr/sim_avr.h")
HAS_BOARD = HEADER.is_file() and all(shutil.which(tool) for tool in ("gcc", "avr-gcc"))
collect_ignore = [
    *(
        [] if HAS_BOARD else ["test_board.py"]
    ),  # apt-get install -y gcc gcc-avr avr-libc simavr libsimavr-dev libelf-dev
    *([] if importlib.util.find_spec("serial") else ["test_serial_link.py"]),  # pip install pyserial
]

LIMITS = DriveLimits(wheel_rad_s=20.0, wheel_radius_m=0.05, track_m=0.2)
"""At these numbers v m/s and w rad/s are 20 v + 2 w rad/s of the right wheel and 20 v - 2 w of the left."""


@pytest.fixture
def limits():
    return LIMITS


@pytest.fixture
def command():
    def make(v=0.2, w=0.5, state=State.LINE, **others):
        return CommandFrame(state, 20.0 * v + 2.0 * w, 20.0 * v - 2.0 * w, v, w, **others)

    return make


@pytest.fixture
def seen():
    def make(increments=(10, 12), **others):
        return SensorFrame(increments, (1.0,) * 8, 0.5, 0.3, 2.0, **others)

    return make


@pytest.fixture(scope="session")
def board_program(tmp_path_factory):
    return build_board(tmp_path_factory.mktemp("board"))


@pytest.fixture(scope="session")
def obedient(tmp_path_factory):
    """Makes the firmware of `obedient.c` at a baud rate."""
    folder = tmp_path_factory.mktemp("obedient")
    source = Path(__file__).with_name("obedient.c")

    def make(baud=500_000):
        elf = folder / f"{baud}.elf"
        if not elf.exists():
            flags = ["-mmcu=atmega2560", "-DF_CPU=16000000UL", f"-DBAUD={baud}UL", "-Os"]
            subprocess.run([shutil.which("avr-gcc"), *flags, "-o", elf, source], check=True)
        return elf

    return make
