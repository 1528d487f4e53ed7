"""One fault of a dataset: the file that has it and what it is."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from symolo.core.errors import one_line

MAX_PER_KIND = 5
"""Largest number of reported faults of one kind, since a file in wrong units has a fault in each row."""


@dataclass(frozen=True)
class Finding:
    """One fault of a dataset."""

    file: str
    what: str

    def __str__(self) -> str:
        return one_line(f"{self.file}: {self.what}")


def limited(name: str, faults: Sequence[str]) -> Iterator[Finding]:
    """Yield the first few faults of a file, and the number of the others."""
    for fault in faults[:MAX_PER_KIND]:
        yield Finding(name, fault)
    if len(faults) > MAX_PER_KIND:
        yield Finding(name, f"and {len(faults) - MAX_PER_KIND} more of this kind")
