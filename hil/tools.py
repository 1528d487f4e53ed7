"""Debian packages that the firmware and the simulated board need; nothing else in the project needs them."""

import shutil
from pathlib import Path

AVR_PACKAGES = "gcc-avr avr-libc"
"""Packages that build firmware for a board."""
NATIVE_PACKAGES = "gcc libc6-dev"
"""Packages that build the firmware for this machine, as some tests do."""
BOARD_PACKAGES = "gcc libc6-dev simavr libsimavr-dev libelf-dev"
"""Packages that build the simulated board."""
HIL_PACKAGES = "gcc libc6-dev gcc-avr avr-libc simavr libsimavr-dev libelf-dev"
"""All packages for hardware in the loop."""

_SIMAVR = Path("/usr/include/simavr/sim_avr.h")


def has_compiler() -> bool:
    return shutil.which("gcc") is not None


def has_avr_compiler() -> bool:
    return shutil.which("avr-gcc") is not None


def has_board() -> bool:
    """Return whether the simulated board and its firmware can be built."""
    return has_compiler() and has_avr_compiler() and _SIMAVR.is_file()
