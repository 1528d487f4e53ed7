"""Distribution of the files of a release over tars: a run lies in one tar, unless it is larger than the limit."""

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
    """A file of the release; it is refused if it has changed since the release was checked."""

    digest: str
    """SHA-256 of the content."""

    @property
    def content(self) -> bytes:
        return read_known(Path(str(self.source)), self.digest)


@dataclass(frozen=True)
class PlannedShard:
    """A tar with some of the files of a release."""

    name: str
    members: tuple[KnownMember, ...]

    @property
    def size(self) -> int:
        return tar_bytes(self.members)


def planned_shards(root: Path, digests: Mapping[str, str], folder: str, max_bytes: int) -> list[PlannedShard]:
    """Return the shards of a release, the same for the same release and size.

    Args:
        root: The release.
        digests: SHA-256 of each of its files.
        folder: Folder to which the shards unpack.
        max_bytes: Largest size of a shard, unless one file is larger.
    """
    ordered = sorted(digests, key=lambda name: ("/" in name, name))  # the files of the dataset itself come first
    members = [KnownMember(f"{folder}/{name}", root / name, digests[name]) for name in ordered]
    planned = []
    for number, part in enumerate(shards(_groups(members, max_bytes), max_bytes)):
        # mlcroissant caches what it unpacked by the name of the tar alone, so the name depends on the content.
        content = hashlib.sha256(manifest({member.name: member.digest for member in part})).hexdigest()
        planned.append(PlannedShard(f"{folder}-{number:05d}-{content[:8]}.tar", part))
    return planned


def _groups(members: list[KnownMember], max_bytes: int) -> Iterator[tuple[KnownMember, ...]]:
    """Yield the members of each run, or single members where a run is larger than a shard."""
    for _, run_members in groupby(members, key=lambda member: member.name.split("/")[1:-1][:2]):
        group = tuple(run_members)
        if tar_bytes(group) <= max_bytes:
            yield group
        else:
            yield from ((member,) for member in group)
