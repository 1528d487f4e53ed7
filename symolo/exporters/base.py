"""What an exporter is: another format for a release, as a list of files that are made when they are written."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from symolo.core.files.plain_files import FileKind, read_file
from symolo.reader.dataset import Dataset
from symolo.reader.run import Image


class ExportedFile(Protocol):
    """One file of an export; the same bytes for the same release."""

    @property
    def name(self) -> str:
        """Its path within the folder of the format."""
        ...

    def size_bytes(self) -> int:
        """How large it will be."""
        ...

    def room_bytes(self) -> int:
        """About how large, told at once."""
        ...

    def content(self) -> bytes: ...


@dataclass(frozen=True)
class MadeFile:
    """One that is worked out."""

    name: str
    make: Callable[[], bytes]
    about: Callable[[], int] | None = None
    """About how large it will be, of one that takes long to make."""

    def size_bytes(self) -> int:
        return len(self.make())

    def room_bytes(self) -> int:
        return self.about() if self.about else self.size_bytes()

    def content(self) -> bytes:
        return self.make()


@dataclass(frozen=True)
class CopiedFile:
    """One of the release as it is, under another name."""

    name: str
    source: Path

    def size_bytes(self) -> int:
        return self.source.stat().st_size

    def room_bytes(self) -> int:
        return self.size_bytes()

    def content(self) -> bytes:
        return read_file(self.source, FileKind.ANY)


def pictures_bytes(images: Iterable[Image]) -> int:
    """The files of some images, without their annotations."""
    return sum(image.path.stat().st_size for image in images)


@dataclass(frozen=True)
class ExportSettings:
    shard_bytes: int
    """Largest shard, of formats that have shards."""


@dataclass(frozen=True)
class Exporter:
    name: str
    """What `--format` takes, and the folder of what it makes."""
    what: str
    """What it makes, in a line for people."""
    files: Callable[[Dataset, ExportSettings], Iterable[ExportedFile]]
    """Lists every file before one is written; raises InputError for a release that lacks what the format needs."""
