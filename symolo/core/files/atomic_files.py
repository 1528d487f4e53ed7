"""Writing of files: whole or not at all, and synced to the disk before anybody relies on them.

All packages write their files with this module, which an architecture test checks. A file or folder whose name begins
with a dot and ends in `.tmp` or `.dropped` is unfinished, and belongs to nobody once its process is gone.
"""

import contextlib
import errno
import glob
import hashlib
import os
import re
import secrets
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path

from symolo.core.files.file_hashes import sha256_of
from symolo.core.files.file_locks import can_rename_locked, lock

UNFINISHED = re.compile(r"\.(.+)\.([0-9a-f]{1,16})\.tmp")
WRITER = "SYMOLO_WRITER"
"""Environment variable with the first half of the random digits in the unfinished names of a process and its children.
The process that ends them can then distinguish their leftovers from files that others are writing."""
DROPPED = re.compile(r"\..+\.dropped")
_FLAGS = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
"""Windows writes bytes as they are only with `O_BINARY`; descriptors are not inherited there anyway."""


def write_file(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Put a whole file in place, or none.

    It is written under an exclusive name beside its place, synced, read back, renamed, and the folder synced.

    Args:
        path: Path of the file.
        data: Content.
        mode: Permissions of the file, before the umask.

    Raises:
        OSError: The disk did not take it, or does not give back what was written. The place is as it was before.
    """
    with _whole(path) as beside:
        _write_beside(beside, (data,), mode)
        _check_stored(beside, data, path)


def write_chunks(path: Path, chunks: Iterable[bytes]) -> str:
    """Put a whole file in place, or none, that is too large for the memory; return its SHA-256.

    Raises:
        OSError: As for `write_file`.
    """
    written = hashlib.sha256()

    def noted() -> Iterator[bytes]:
        for chunk in chunks:
            written.update(chunk)
            yield chunk

    with contextlib.ExitStack() as renamed, _whole(path) as beside:
        _write_beside(beside, noted(), lock_until=renamed if can_rename_locked() else None)
        digest = sha256_of(beside)
        if digest != written.hexdigest():
            raise OSError(errno.EIO, "what is on the disk is not what was written", str(path))
    return digest


@contextlib.contextmanager
def _whole(path: Path) -> Iterator[Path]:
    """Yield an exclusive name beside a path, for a file that takes this path when the block ends."""
    beside = _unfinished(path)
    try:
        yield beside
        os.replace(beside, path)  # noqa: PTH105 - of the two ways to say it the one that a fault test can stand in for
        _check_gone(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def _check_gone(old: Path, new: Path) -> None:
    """Raise where a disk reports that it has renamed something and has not; the old name is nobody else's."""
    if old.exists():
        raise _lost(new)


def _lost(place: Path) -> OSError:
    return OSError(errno.EIO, "the disk has lost a renaming", str(place))


def _unfinished(path: Path) -> Path:
    """Return a random name. The number of the process would not do: after a restart, another process may have it."""
    return path.with_name(f".{path.name}.{os.environ.get(WRITER) or new_writer()}{secrets.token_hex(4)}.tmp")


def new_writer() -> str:
    """Return a value for `WRITER` that no other process has."""
    return secrets.token_hex(4)


def place_of(unfinished: Path) -> Path | None:
    """Return the path for which an unfinished file or folder was meant; None for any other name."""
    match = UNFINISHED.fullmatch(unfinished.name)
    return unfinished.with_name(match.group(1)) if match else None


def remove_left_of(path: Path) -> None:
    """Remove what killed processes left of a file that `write_chunks` wrote.

    What another process is writing stays, and so does what belongs to another user. Where a locked file cannot be
    renamed, nothing is removed, because nothing shows that its process is gone.
    """
    if not can_rename_locked() or not path.parent.is_dir():
        return
    for beside in path.parent.glob(f".{glob.escape(path.name)}.*.tmp"):
        if place_of(beside) == path and not beside.is_symlink() and beside.is_file():
            # Another process holds or has just renamed it, it is another user's, or the disk has no locks.
            with contextlib.suppress(OSError):
                _remove_unlocked(beside)


def _remove_unlocked(path: Path) -> None:
    """Remove a file; raise OSError, such as BlockingIOError, if another process has locked it."""
    descriptor = os.open(path, os.O_RDWR | _FLAGS | getattr(os, "O_NOFOLLOW", 0))
    try:
        lock(descriptor, wait=False)
        remove_file(path)
    finally:
        os.close(descriptor)


def _write_beside(
    beside: Path, chunks: Iterable[bytes], mode: int = 0o666, *, lock_until: contextlib.ExitStack | None = None
) -> None:
    """Write a new file, and keep it locked until the end of a block if there is one."""
    with contextlib.ExitStack() as written:
        descriptor = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _FLAGS | getattr(os, "O_NOFOLLOW", 0), mode)
        (lock_until or written).callback(os.close, descriptor)
        if lock_until:  # shows that its process still lives, where the disk has locks
            with contextlib.suppress(OSError):
                lock(descriptor, wait=False)
        for chunk in chunks:
            _write_all(descriptor, chunk, beside)
        os.fsync(descriptor)


def _check_stored(beside: Path, data: bytes, path: Path) -> None:
    stored = beside.read_bytes()
    if stored != data:
        problem = f"what is on the disk is not what was written ({len(stored)} of {len(data)} bytes)"
        raise OSError(errno.EIO, problem, str(path))


def _write_all(descriptor: int, data: bytes, path: Path) -> None:
    """Write all bytes: a write may accept fewer bytes, and only the next write says why. The error names the path."""
    left = memoryview(data)
    while left:
        try:
            left = left[os.write(descriptor, left) :]
        except OSError as error:
            error.filename = str(path)
            raise


def append_line(path: Path, line: bytes) -> None:
    """Add a line to a journal, which is the only kind of file that grows in place; several processes may.

    A line that was cut short by a kill or a full disk stays what it is, a line of its own that no reader understands.

    Raises:
        OSError: The disk did not take it; what it took of the line is taken away again.
    """
    new = not path.exists()
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | _FLAGS, 0o666)
    try:
        lock(descriptor)
        end = os.fstat(descriptor).st_size
        os.lseek(descriptor, max(end - 1, 0), os.SEEK_SET)  # what is written is appended wherever this stands
        cut = os.read(descriptor, 1) not in {b"", b"\n"}
        try:
            _write_all(descriptor, b"\n" * cut + line + b"\n", path)
            os.fsync(descriptor)
        except BaseException:
            with contextlib.suppress(OSError):
                os.ftruncate(descriptor, end)
            raise
    finally:
        os.close(descriptor)
    if new:
        sync_folder(path.parent)


def sync_folder(path: Path) -> None:
    """Make the names in a folder durable; a rename alone may be lost when the power fails.

    Systems without `O_DIRECTORY`, such as Windows, do not open folders and do without.
    """
    if not hasattr(os, "O_DIRECTORY"):
        return
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | _FLAGS)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def make_folder(path: Path) -> None:
    """Make a folder and those above it that are not there, and put their names on the disk."""
    missing = [folder for folder in (path, *path.parents) if not folder.exists()]
    path.mkdir(parents=True, exist_ok=True)
    for folder in missing:
        sync_folder(folder.parent)


def new_folder_beside(path: Path) -> Path:
    """Return a new empty folder that only the caller uses, to be filled and moved to `path`."""
    beside = _unfinished(path)
    make_folder(beside)
    return beside


def move(path: Path, place: Path) -> None:
    """Rename a whole file to another folder of the same disk, over what is there."""
    os.replace(path, place)  # noqa: PTH105 - as above
    _check_gone(path, place)
    _sync_renaming(path, place)


def _sync_renaming(old: Path, new: Path) -> None:
    """Put a renaming on the disk; both folders are synced, or the old name may come back when the power fails."""
    for folder in dict.fromkeys((new.parent, old.parent)):
        sync_folder(folder)


def replace_folder(new: Path, path: Path) -> None:
    """Put the finished folder `new` where `path` is; an older folder there is dropped first."""
    remove_folder(path)
    place_folder(new, path)


def place_folder(new: Path, path: Path) -> None:
    """Put the finished folder `new` where there is nothing, or an empty folder.

    Raises:
        FileExistsError: There is something else; it stays as it is.
    """
    make_folder(path.parent)
    try:
        with contextlib.suppress(FileNotFoundError):
            path.rmdir()  # Windows renames nothing to the path of an empty folder
        os.rename(new, path)  # noqa: PTH104 - as above
    except OSError as error:
        if error.errno in {errno.EEXIST, errno.ENOTEMPTY, errno.ENOTDIR}:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path)) from None
        raise
    _check_gone(new, path)
    _sync_renaming(new, path)


def remove_folder(path: Path) -> None:
    """Remove a folder; it is renamed first, so that no half-removed folder is ever seen under its name."""
    dropped = path.with_name(f".{path.name}.dropped")
    # Also when the folder itself is gone: a removal killed half-way left it under this name.
    if dropped.exists():
        remove_unfinished_folder(dropped)
    if path.exists():
        os.rename(path, dropped)  # noqa: PTH104 - as above
        if not dropped.exists():
            raise _lost(dropped)
        sync_folder(path.parent)
        remove_unfinished_folder(dropped)


def remove_unfinished_folder(folder: Path) -> None:
    """Remove a folder whose name says that it is unfinished, so that it does not come back when the power fails."""
    shutil.rmtree(folder)
    sync_folder(folder.parent)


def empty_unfinished_folder(folder: Path) -> None:
    """Remove everything in a folder whose name says that it is unfinished; the folder itself may be locked."""
    for path in list(folder.iterdir()):
        if path.is_dir() and not path.is_symlink():
            remove_unfinished_folder(path)
        else:
            remove_file(path)


def remove_file(path: Path) -> None:
    """Remove a file or a link, if it is there, before anything else is done."""
    if path.exists() or path.is_symlink():
        path.unlink()
        sync_folder(path.parent)


def remove_leftovers(folder: Path, *, below: bool = False, of: str = "") -> None:
    """Remove what a killed process left unfinished in a folder, or also in those `below`.

    No other process may be writing there, unless only the leftovers `of` one `WRITER` are removed.
    """
    folders = [folder] if folder.is_dir() else []
    while folders:  # a recursion would end on untrusted folders that are a thousand levels deep
        for path in list(folders.pop().iterdir()):
            if path.is_symlink():
                continue
            if path.is_dir():
                if _is_left(path, of) or (not of and DROPPED.fullmatch(path.name)):
                    remove_unfinished_folder(path)
                elif below:
                    folders.append(path)
            elif _is_left(path, of):
                remove_file(path)


def _is_left(path: Path, writer: str) -> bool:
    match = UNFINISHED.fullmatch(path.name)
    return match is not None and match.group(2).startswith(writer)
