"""Interface of a store: it keeps the files of a release as objects, each under its path within the release."""

import hashlib
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from symolo.core.errors import InputError
from symolo.core.files.plain_files import open_file

CHUNK_BYTES = 8 << 20
"""Number of bytes that are read of a file at a time; a larger file is sent in parts of this size."""


@dataclass(frozen=True)
class LocalFile:
    """One file of a release."""

    name: str
    """Path within the release."""
    path: Path
    size_bytes: int
    digest: str
    """SHA-256 of the content."""

    def chunks(self) -> Iterator[bytes]:
        """Yield the bytes; the last chunk follows only after the checksum of the whole file turned out right.

        Raises:
            InputError: The file has changed meanwhile.
        """
        hashed, last = hashlib.sha256(), b""
        with open_file(self.path) as file:
            while chunk := file.read(CHUNK_BYTES):
                hashed.update(chunk)
                if last:
                    yield last
                last = chunk
        if hashed.hexdigest() != self.digest:
            raise InputError("has changed meanwhile", where=str(self.path), cure="run the command again")
        yield last


class Store(Protocol):
    """A place that keeps files by their path. Several threads may use it at the same time.

    Every method raises EnvironmentLacking if the store cannot be reached or refuses access.
    """

    @property
    def url(self) -> str:
        """Return the address as the user wrote it."""
        ...

    def locked(self) -> AbstractContextManager[None]:
        """Lock the store for this process, if it has locks.

        Raises:
            InputError: Another process has locked it.
        """
        ...

    def sweep(self) -> None:
        """Remove what an interrupted upload left; the caller has locked the store."""
        ...

    def sizes(self) -> dict[str, int]:
        """Return the size [bytes] of each complete object by its path.

        Raises:
            InputError: There is no such place.
        """
        ...

    def digest(self, name: str) -> str:
        """Return the SHA-256 of an object without a transfer of its bytes; empty if the store does not know it."""
        ...

    def put(self, file: LocalFile) -> None:
        """Store a file completely, or leave the object as it was.

        Raises:
            InputError: The file has changed meanwhile.
        """
        ...

    def get(self, name: str) -> bytes | None:
        """Return all bytes of an object; None if there is no such object."""
        ...
