"""What a machine needs for firmware and the simulated board, as Debian packages; nothing else in the project does."""

import shutil
from pathlib import Path

AVR_PACKAGES = "gcc-avr avr-libc"
"""To build firmware for a board."""
NATIVE_PACKAGES = "gcc libc6-dev"
"""To build it for this machine, as some tests do."""
BOARD_PACKAGES = "gcc libc6-dev simavr libsimavr-dev libelf-dev"
"""To build the simulated board."""
HIL_PACKAGES = "gcc libc6-dev gcc-avr avr-libc simavr libsimavr-dev libelf-dev"
"""All of them."""

_SIMAVR = Path("/usr/include/simavr/sim_avr.h")


def has_compiler() -> bool:
    """For this machine."""
    return shutil.which("gcc") is not None


def has_avr_compiler() -> bool:
    return shutil.which("avr-gcc") is not None


def has_board() -> bool:
    """Whether the simulated board can be built and given firmware."""
    return has_compiler() and has_avr_compiler() and _SIMAVR.is_file()
