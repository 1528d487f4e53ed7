"""Tar files that are the same bytes for the same content: headers without owner, date and machine."""

import tarfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from symolo.core.batches import batches
from symolo.core.files.plain_files import FileKind, read_file

_END_BYTES = 2 * tarfile.BLOCKSIZE


@dataclass(frozen=True)
class Member:
    """A file in a tar: its bytes, or the path of the file that holds them."""

    name: str
    source: bytes | Path

    @property
    def size(self) -> int:
        return len(self.source) if isinstance(self.source, bytes) else self.source.stat().st_size

    @property
    def content(self) -> bytes:
        return self.source if isinstance(self.source, bytes) else read_file(self.source, FileKind.ANY)

    @property
    def head(self) -> bytes:
        """Header without owner, date and machine."""
        info = tarfile.TarInfo(self.name)
        info.size, info.mode, info.mtime = self.size, 0o644, 0
        return info.tobuf(tarfile.USTAR_FORMAT)

    @property
    def padded(self) -> int:
        """Size in the tar [bytes], with the header and filled to whole blocks."""
        return len(self.head) + -(-self.size // tarfile.BLOCKSIZE) * tarfile.BLOCKSIZE


AnyMember = TypeVar("AnyMember", bound=Member)


def tar_bytes(members: Iterable[Member]) -> int:
    """Return the size of the tar of these members."""
    return _whole_records(sum(member.padded for member in members))


def tar_chunks(members: Iterable[Member]) -> Iterator[bytes]:
    """Yield the content of the tar, one member at a time."""
    written = 0
    for member in members:
        data = member.content
        chunk = member.head + data + b"\0" * (-len(data) % tarfile.BLOCKSIZE)
        written += len(chunk)
        yield chunk
    yield b"\0" * (_whole_records(written) - written)


def shards(groups: Iterable[Sequence[AnyMember]], max_bytes: int) -> Iterator[tuple[AnyMember, ...]]:
    """Yield the members of each tar; a group lies in one tar, and only a tar of one group may exceed `max_bytes`."""
    room = max_bytes // tarfile.RECORDSIZE * tarfile.RECORDSIZE - _END_BYTES
    for batch in batches(groups, lambda group: sum(member.padded for member in group), room):
        yield tuple(member for group in batch for member in group)


def _whole_records(used: int) -> int:
    return -(-(used + _END_BYTES) // tarfile.RECORDSIZE) * tarfile.RECORDSIZE
