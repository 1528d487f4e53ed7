"""How a file is written (beside, synced, renamed) and how one is recognised (SHA-256)."""

import contextlib
import errno
import hashlib
import json
import os
import re
import shutil
from collections.abc import Collection, Mapping
from pathlib import Path

LEFT_FILE = re.compile(r"\..+\.[0-9]+\.tmp")
LEFT_FOLDER = re.compile(r"\..+\.dropped")
DISK_FULL = frozenset({errno.ENOSPC, errno.EDQUOT})


def sha256_of(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def hashes_of(folder: Path, skip: Collection[str] = ()) -> dict[str, str]:
    """SHA-256 of every file below a folder by its path inside, sorted; `skip` names entries of the folder itself."""
    paths = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    names = sorted(path.as_posix() for path in paths if path.parts[0] not in skip)
    return {name: sha256_of(folder / name) for name in names}


def holds(folder: Path, files: Mapping[str, str]) -> bool:
    """Whether each of the files is there with the SHA-256 named."""
    return all((folder / name).is_file() and sha256_of(folder / name) == digest for name, digest in files.items())


def canonical_json(value: object) -> bytes:
    """JSON text that is the same bytes for the same value: sorted keys, two spaces, one line end."""
    return (json.dumps(value, sort_keys=True, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()


def write_file(path: Path, data: bytes) -> None:
    """Put a whole file in place or none: written under an exclusive temporary name, synced, renamed."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with temporary.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(path: Path) -> None:
    """Make the names in a folder durable; a rename alone may be lost when the power fails."""
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def replace_folder(new: Path, path: Path) -> None:
    """Put the finished folder `new` where `path` is; an older folder there is dropped first."""
    remove_folder(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    new.rename(path)
    sync_folder(path.parent)


def remove_folder(path: Path) -> None:
    """Remove a folder; it is renamed first, so that no half-removed folder is ever seen under its name."""
    dropped = path.with_name(f".{path.name}.dropped")
    # Also when the folder itself is gone: a removal killed half-way left it under this name.
    shutil.rmtree(dropped, ignore_errors=True)
    if path.exists():
        path.rename(dropped)
        shutil.rmtree(dropped)


def remove_leftovers(folder: Path) -> None:
    """Remove what a killed `write_file` or `remove_folder` left directly in a folder that nobody else writes to."""
    for path in list(folder.iterdir()):
        if path.is_symlink():
            continue
        if path.is_file() and LEFT_FILE.fullmatch(path.name):
            path.unlink()
        elif path.is_dir() and LEFT_FOLDER.fullmatch(path.name):
            shutil.rmtree(path)
