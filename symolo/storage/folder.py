"""A folder as a store, such as a mounted disk: files appear complete, and are on the disk when `put` returns.

`LocalStore` of obstore 0.12.1 is not used: it renames files into place without waiting for the disk, takes no metadata
such as checksums, writes through symbolic links, and would need an extra for plain folders.
"""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, place_of, remove_leftovers, write_file
from symolo.core.files.file_hashes import sha256_of, sizes_below
from symolo.core.files.file_locks import locked_or_refused
from symolo.core.files.paths import check_new_path
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.os_errors import NOT_THERE
from symolo.storage.base import LocalFile


@dataclass(frozen=True)
class Folder:
    """A folder as a store."""

    url: str
    root: Path

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Hold a lock of the operating system, which releases it however the process ends."""
        check_new_path(self.root, "URL")
        make_folder(self.root)
        with locked_or_refused(self.root, self.url):
            yield

    def sweep(self) -> None:
        remove_leftovers(self.root, below=True)

    def sizes(self) -> dict[str, int]:
        there = ((path, size) for path, size in sizes_below(self.root) if not place_of(path))
        return {path.relative_to(self.root).as_posix(): size for path, size in there}

    def digest(self, name: str) -> str:
        try:
            return sha256_of(self.root / name)
        except NOT_THERE:  # gone since it was listed
            return ""

    def put(self, file: LocalFile) -> None:
        place = self.root / file.name
        if place.parent.resolve() != (self.root.resolve() / file.name).parent:
            raise InputError("leads through a link", where=f"{self.url}: {file.name}", cure="remove the link")
        make_folder(place.parent)
        write_file(place, b"".join(file.chunks()))

    def get(self, name: str) -> bytes | None:
        try:
            return read_file(self.root / name, FileKind.ANY)
        except NOT_THERE:
            return None
