"""A drive whose numbers are easy, and a firmware that does what bytes tell it, on a simulated board."""

import shutil
import subprocess
from pathlib import Path

import pytest

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from hil.board.build import build_board
from hil.frames import CommandFrame, SensorFrame
from hil.plausibility import DriveLimits
from symolo.dataset.codes import State

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
def programs(pytestconfig):
    """Where what is built is kept from run to run, by the hash of what it is built from."""
    return Path(pytestconfig.cache.mkdir("firmware"))


@pytest.fixture(scope="session")
def board_program(programs):
    return build_board(programs)


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


@pytest.fixture(scope="session")
def nominal():
    return RobotConfig.model_validate(load_section("robot", "nominal").tree)


@pytest.fixture(autouse=True)
def _benchmarks_on_the_path(monkeypatch):
    """Benchmarks are scripts that import each other as they do when they are run."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks" / "hil"))
