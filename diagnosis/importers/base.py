"""What an importer is: one kind of file or folder that holds measured data, and how to read it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from diagnosis.measured.measurement import Measurement
from symolo.core.files.plain_files import open_named_file


@dataclass(frozen=True)
class Importer:
    name: str
    """What `--importer` takes."""
    what: str
    """What it reads, in a line for people."""
    recognises: Callable[[Path], bool]
    """Whether a file or folder looks like that, from names or its first lines; never raises."""
    read: Callable[[Path], Measurement]
    """Reads all of it strictly, or raises InputError that names file, row and column."""


def is_file(path: Path) -> bool:
    """Whether there is such a file within reach; false, and no PermissionError, in a folder without permission."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_folder(path: Path) -> bool:
    """The same of a folder."""
    try:
        return path.is_dir()
    except OSError:
        return False


def only_log(path: Path, is_log: Callable[[Path], bool]) -> Path | None:
    """The file itself, or the only file of a folder that looks like a log; None where there is none or several."""
    if not is_folder(path):
        return path if is_log(path) else None
    found = [file for file in path.glob("*.csv") if is_log(file)]
    return found[0] if len(found) == 1 else None


def first_line(path: Path) -> str:
    """Of a file, without spaces; empty for a folder or what cannot be read."""
    if not is_file(path):  # nor a pipe or a device, on which one would wait
        return ""
    try:
        with open_named_file(path) as file:
            return "".join(file.readline(4096).decode("utf-8-sig", errors="replace").split())
    except (OSError, ValueError):
        return ""
