"""Builds the simulated board with the machine's C compiler, once for each version of its source."""

import hashlib
import os
import shutil
import subprocess
from pathlib import Path

from hil.tools import BOARD_PACKAGES
from symolo.core.errors import EnvironmentLacking
from symolo.core.files.atomic_files import make_folder, move
from symolo.core.files.scratch_folders import scratch_folder

SOURCE = Path(__file__).with_name("board.c")
_FLAGS = ("-O2", "-std=gnu11", "-Wall")
_LIBRARIES = ("-lsimavr", "-lelf")
_SIGNS_OF_MISSING_FILES = ("No such file", "cannot find -l", "cannot find crt")


def cache_folder() -> Path:
    """Return the folder for built programs: `symolo` in the user's cache folder."""
    return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "symolo"


def build_board(folder: Path | None = None) -> Path:
    """Return the simulated board as a program in `folder`, by default the user's cache; build it if it is missing.

    Raises:
        EnvironmentLacking: There is no C compiler, or simavr or libelf is missing; names the line that installs them.
        RuntimeError: The source does not compile; the text ends with the compiler's messages.
    """
    folder = folder or cache_folder()
    source = SOURCE.read_bytes()
    digest = hashlib.sha256(source + " ".join(_FLAGS + _LIBRARIES).encode()).hexdigest()
    place = folder / f"board-{digest[:16]}"
    if place.is_file():
        return place
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        raise EnvironmentLacking(_lacking("there is no C compiler"))
    make_folder(folder)
    with scratch_folder(folder) as scratch:
        program = scratch / "board"
        command = [compiler, *_FLAGS, str(SOURCE), "-o", str(program), *_LIBRARIES]
        compiled = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
        if compiled.returncode:
            raise _failure(compiled.stderr)
        move(program, place)
    return place


def _failure(messages: str) -> Exception:
    for line in messages.splitlines():
        if any(sign in line for sign in _SIGNS_OF_MISSING_FILES):
            return EnvironmentLacking(_lacking(line.strip()))
    return RuntimeError(f"the simulated board does not compile: {messages[-2000:]}")


def _lacking(what: str) -> str:
    return f"the simulated board cannot be built: {what}; run `apt-get install -y {BOARD_PACKAGES}`"
