"""Numbers from the text files of a measurement, with the place of each that is none."""

import math
from pathlib import Path

from configs.errors import InputError

LARGEST_BYTES = 100_000_000
LARGEST_RANGE_MM = 8189.0
"""The device's codes for "no target" begin above."""


def lines_of(path: Path) -> list[str]:
    """The lines of a text file, without the mark that some tables begin with.

    Raises:
        InputError: Too large, out of reach, or no text.
    """
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise InputError("is too large", where=str(path), allowed=f"{LARGEST_BYTES / 1e6:.0f} MB")
        return path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError("is no UTF-8 text", where=str(path)) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None


def number(text: str, path: Path, row: int, column: str) -> float:
    """A finite number; `row` counts from 1, with the header.

    Raises:
        InputError: It is none; the text names file, row and column.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"column {column}", where=f"{path}: row {row}", got=text.strip(), allowed="a number")
    return value


def range_mm(text: str, path: Path, row: int, column: str) -> float:
    """A reading of the device [mm].

    Raises:
        InputError: No number, or none that is a distance.
    """
    value = number(text, path, row, column)
    if not 0.0 <= value <= LARGEST_RANGE_MM:
        allowed = f"a distance from 0 to {LARGEST_RANGE_MM:.0f} mm"
        raise InputError(f"column {column}", where=f"{path}: row {row}", got=value, allowed=allowed)
    return value


def csv_files(folder: Path, option: str) -> list[Path]:
    """The .csv files of a folder, by name.

    Raises:
        InputError: No folder, or none in it.
    """
    if not folder.is_dir():
        raise InputError("no such folder", where=f"{option} {folder}", cure="name a folder of measured .csv files")
    found = sorted(path for path in folder.glob("*.csv") if path.is_file())
    if not found:
        raise InputError("holds no .csv file", where=f"{option} {folder}", cure="name a folder of measured .csv files")
    return found
