"""Readings of the device in text files of a measurement, and the folders that hold them."""

from pathlib import Path

from diagnosis.measured.text_file import number
from symolo.core.errors import InputError

LARGEST_RANGE_MM = 8189.0
"""The device's codes for "no target" begin above."""


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
