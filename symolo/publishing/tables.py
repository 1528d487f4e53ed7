"""The tables of all runs below each other, with the run in a first column and the digits of the files.

They lie beside the shards, so that a user of the numbers needs to unpack nothing, and because `mlcroissant` cannot read
the many tables of an archive as one.
"""

import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.file_hashes import read_known
from symolo.core.files.plain_files import FileKind, open_file, read_file
from symolo.dataset.documents.metadata import METADATA
from symolo.dataset.layout import DATA

RUN = "run"


@dataclass(frozen=True)
class PlannedTable:
    """One table with the rows of all runs."""

    name: str
    """`rows` for data.csv, otherwise the name of the side table."""
    source: str
    """Path within the folder of a run, for example `side/wheels.csv`."""
    kinds: Mapping[str, str]
    """Croissant's data type of each column."""
    files: Sequence[tuple[str, Path, str]]
    """Run, path and SHA-256 of each file."""
    size: int
    """Size of the whole table [bytes]."""

    @property
    def file(self) -> str:
        return f"{self.name}.csv"

    def chunks(self) -> Iterator[bytes]:
        """Yield the table, one run at a time.

        Raises:
            EnvironmentLacking: A file has changed since the release was checked.
        """
        for number, (run, path, digest) in enumerate(self.files):
            header, *lines = read_known(path, digest).splitlines(keepends=True)
            if number == 0:
                yield f"{RUN},".encode() + header
            yield b"".join(f"{run},".encode() + line for line in lines)


def planned_table(
    root: Path, runs: Sequence[str], source: str, columns: Sequence[str], digests: Mapping[str, str]
) -> PlannedTable:
    """Return the table of one file of every run.

    Args:
        root: The release.
        runs: Names of its runs.
        source: Path of the file within the folder of a run.
        columns: Names of the columns in metadata.json.
        digests: SHA-256 by path within the release.

    Raises:
        InputError: No run has the file, or it has other columns.
    """
    files = [(run, root / run / source, digests[f"{run}/{source}"]) for run in runs if f"{run}/{source}" in digests]
    if not files:
        raise InputError(f"names a table {source} that no run has", where=str(root / METADATA))
    with open_file(files[0][1]) as file:
        header, first = file.readline(), file.readline()
    if header.decode(errors="replace").strip().split(",") != list(columns):
        raise InputError(f"{METADATA} names other columns", where=str(files[0][1]), allowed=", ".join(columns))
    size = len(f"{RUN},") + len(header)
    for run, path, _ in files:
        content = read_file(path, FileKind.TABLE)
        # Each file loses its header, and each of its other lines gets the name of the run.
        size += len(content) - len(header) + (content.count(b"\n") - 1) * len(f"{run},")
    name = "rows" if source == DATA else Path(source).stem
    return PlannedTable(name, source, _kinds(header, first), files, size)


def _kinds(header: bytes, first: bytes) -> dict[str, str]:
    """Return Croissant's data type of each column; the first row suffices, since columns have fixed digits."""
    names, values = csv.reader((header + first).decode().splitlines())
    return {name: _kind(value) for name, value in zip(names, values, strict=True)}


def _kind(value: str) -> str:
    try:
        float(value)
    except ValueError:
        return "sc:Text"
    return "sc:Integer" if value.lstrip("-").isdigit() else "sc:Float"
