"""Which file of a release lies in which tar: a run in one of them, unless it is larger than one may be."""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from symolo.core.files.file_hashes import read_known
from symolo.core.files.tar_files import Member, shards, tar_bytes
from symolo.dataset.manifest import manifest


@dataclass(frozen=True)
class KnownMember(Member):
    """A file that is still what it was when the release was checked, or is refused."""

    digest: str

    @property
    def content(self) -> bytes:
        return read_known(Path(str(self.source)), self.digest)


@dataclass(frozen=True)
class PlannedShard:
    name: str
    members: tuple[KnownMember, ...]

    @property
    def size(self) -> int:
        return tar_bytes(self.members)


def planned_shards(root: Path, digests: Mapping[str, str], folder: str, max_bytes: int) -> list[PlannedShard]:
    """Every file below `folder`, by name; the same shards for the same release and size.

    Args:
        root: The release.
        digests: SHA-256 of each of its files.
        folder: To which the shards unpack.
        max_bytes: Size of a shard, unless one file is larger.
    """
    members = [KnownMember(f"{folder}/{name}", root / name, digests[name]) for name in sorted(digests, key=_place)]
    parts = shards(_groups(members, max_bytes), max_bytes)
    return [PlannedShard(_name(folder, number, part), part) for number, part in enumerate(parts)]


def _place(name: str) -> tuple[bool, str]:
    """The files of the dataset itself come first."""
    return "/" in name, name


def _groups(members: list[KnownMember], max_bytes: int) -> Iterator[tuple[KnownMember, ...]]:
    for _, of_run in groupby(members, key=lambda member: member.name.split("/")[1:-1][:2]):
        group = tuple(of_run)
        if tar_bytes(group) <= max_bytes:
            yield group
        else:
            yield from ((member,) for member in group)


def _name(folder: str, number: int, members: tuple[KnownMember, ...]) -> str:
    """Told apart by its content: mlcroissant keeps what it unpacked by the name of the tar alone."""
    content = hashlib.sha256(manifest({member.name: member.digest for member in members})).hexdigest()
    return f"{folder}-{number:05d}-{content[:8]}.tar"
