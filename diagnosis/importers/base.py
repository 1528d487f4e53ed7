"""The interface of an importer, which reads one kind of file or folder with measured data."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from diagnosis.measured.measurement import Measurement


@dataclass(frozen=True)
class Importer:
    """A form of measured data: how it is recognised and read."""

    name: str
    """Value of `--importer`."""
    recognises: Callable[[Path], bool]
    """Function that returns whether a file or folder has this form, from names and first lines; it never raises."""
    read: Callable[[Path], Measurement]
    """Function that reads the data strictly, or raises InputError with file, row and column."""
