"""SHA-256 and sizes of files, and JSON whose bytes are the same for the same value."""

import hashlib
import json
import os
import stat
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path

from symolo.core.errors import EnvironmentLacking
from symolo.core.files.plain_files import FileKind, is_plain_file, open_file, read_file
from symolo.core.os_errors import NOT_THERE

_BLOCK_BYTES = 1 << 18


def sha256_of(path: Path, kind: FileKind | None = None) -> str:
    """Return the SHA-256 of a plain file, which is read in blocks.

    Args:
        path: The file.
        kind: Its kind, where a stranger may have made it: a sparse file of a terabyte takes no room and an hour.

    Raises:
        OSError: It is no plain file, is larger than its kind may be, or the disk does not give it.
    """
    digest = hashlib.sha256()
    with open_file(path, kind) as file:
        while block := file.read(_BLOCK_BYTES):
            digest.update(block)
    return digest.hexdigest()


def hashes_of(folder: Path, skip: Collection[str] = ()) -> dict[str, str]:
    """Return the SHA-256 of every file below a folder by its path inside, sorted; `skip` names entries of the folder.

    Raises:
        OSError: A folder or file cannot be read; a list of some of them would pass for one of all.
    """
    paths = (path.relative_to(folder) for path in _files_below(folder) if path.is_file())
    names = sorted(path.as_posix() for path in paths if path.parts[0] not in skip)
    return {name: sha256_of(folder / name) for name in names}


def sizes_below(folder: Path) -> Iterator[tuple[Path, int]]:
    """Yield every regular file below a folder with its size [byte], while other processes may write there.

    Files that vanish meanwhile, links and pipes are left out. A folder that is missing or cannot be read has no files.
    """
    for place, _, names in os.walk(folder):
        for path in (Path(place, name) for name in names):
            try:
                status = path.lstat()
            except NOT_THERE:
                continue
            if stat.S_ISREG(status.st_mode):
                yield path, status.st_size


def _files_below(folder: Path) -> Iterator[Path]:
    """Yield all files, and raise an error for a folder that cannot be read, which `rglob` leaves out."""

    def stop(error: OSError) -> None:
        raise error

    for place, _, names in os.walk(folder, onerror=stop):
        yield from (Path(place, name) for name in names)


def holds(folder: Path, files: Mapping[str, str]) -> bool:
    """Return whether each of the files is there with its SHA-256."""
    return all(is_plain_file(folder / name) and sha256_of(folder / name) == digest for name, digest in files.items())


def missing_files(folder: Path, names: Iterable[str]) -> list[str]:
    """Return which of these files are not in the folder."""
    return [name for name in names if not is_plain_file(folder / name)]


def read_known(path: Path, digest: str) -> bytes:
    """Return the content of a file that is known by its SHA-256.

    Raises:
        EnvironmentLacking: It is no longer what was written.
    """
    data = read_file(path, FileKind.ANY)
    if hashlib.sha256(data).hexdigest() != digest:
        raise EnvironmentLacking(f"{path} is no longer what was written; run the same command again")
    return data


def canonical_json(value: object) -> bytes:
    """Return JSON text that has the same bytes for the same value: sorted keys, two spaces, one line end."""
    return (json.dumps(value, sort_keys=True, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
