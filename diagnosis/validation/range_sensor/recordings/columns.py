"""Readings of the range sensor in text files of a measurement."""

from pathlib import Path

from diagnosis.measured.text_file import number
from symolo.core.errors import InputError

MAX_RANGE_MM = 8189.0
"""The device's codes for "no target" begin above."""


def range_mm(text: str, path: Path, row: int, column: str) -> float:
    """Return a reading of the device [mm].

    Raises:
        InputError: The text is no number, or no distance.
    """
    value = number(text, path, row, column)
    if not 0.0 <= value <= MAX_RANGE_MM:
        allowed = f"a distance from 0 to {MAX_RANGE_MM:.0f} mm"
        raise InputError(f"column {column}", where=f"{path}: row {row}", got=value, allowed=allowed)
    return value
