"""What a store is: a place that keeps the files of a release as objects, each under its path within the release."""

import hashlib
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from symolo.core.errors import InputError
from symolo.core.files.plain_files import open_file

CHUNK_BYTES = 8 << 20
"""What is read of a file at a time; a larger one is sent in parts of this size."""


@dataclass(frozen=True)
class LocalFile:
    """One file of a release that is as it was released."""

    name: str
    """Its path within the release."""
    path: Path
    size_bytes: int
    digest: str
    """SHA-256."""

    def chunks(self) -> Iterator[bytes]:
        """Its bytes, the last of which come only where all of them are those that were checked.

        Raises:
            InputError: The file has changed meanwhile.
        """
        hashed, held = hashlib.sha256(), b""
        with open_file(self.path) as file:
            while chunk := file.read(CHUNK_BYTES):
                hashed.update(chunk)
                if held:
                    yield held
                held = chunk
        if hashed.hexdigest() != self.digest:
            raise InputError("has changed meanwhile", where=str(self.path), cure="run the command again")
        yield held


class Store(Protocol):
    """One file for each kind. Several threads may use one at a time.

    Every method raises EnvironmentLacking where the store cannot be reached or does not let us in.
    """

    @property
    def url(self) -> str:
        """As the user named it."""
        ...

    def held(self) -> AbstractContextManager[None]:
        """For this process alone, where the store knows of such a thing.

        Raises:
            InputError: Another process holds it.
        """
        ...

    def sweep(self) -> None:
        """Remove what a killed upload left unfinished; of a held store that has nothing of others."""
        ...

    def sizes(self) -> dict[str, int]:
        """Bytes of each object by its path; nothing of an object that is still being written.

        Raises:
            InputError: There is no such place.
        """
        ...

    def digest(self, name: str) -> str:
        """SHA-256 of an object, without its bytes being sent; empty where the store does not know it."""
        ...

    def put(self, file: LocalFile) -> None:
        """Store a file whole, or leave what was there.

        Raises:
            InputError: The file has changed meanwhile.
        """
        ...

    def get(self, name: str) -> bytes | None:
        """All bytes of an object; None where there is none."""
        ...
