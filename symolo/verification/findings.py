"""One fault of a dataset: the file that has it and what it is."""

from dataclasses import dataclass

from symolo.core.errors import one_line


@dataclass(frozen=True)
class Finding:
    file: str
    what: str

    def __str__(self) -> str:
        return one_line(f"{self.file}: {self.what}")
