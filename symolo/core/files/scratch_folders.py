"""Folders for temporary files, which are removed with their process, or by the next command if it was killed.

A folder belongs to a process for as long as the process holds the lock on a file in it. The operating system releases
the lock however the process ends, and no number of a process can be mistaken for that of a later one.
"""

import contextlib
import hashlib
import os
import platform
import shutil
import stat
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from symolo.core.files.file_locks import can_lock, lock, opened_lock

OWNER = ".owner.lock"
"""File whose lock the owner of a folder holds; the stages that work in the folder lock another file in it."""


@contextlib.contextmanager
def scratch_folder(parent: Path | None = None) -> Iterator[Path]:
    """Yield a new folder, which is removed at the end with all that is in it.

    The first one that a process makes in a place also removes those that killed processes of the same user left there.

    Args:
        parent: Folder in which it is made; by default the system's folder for temporary files.
    """
    place = Path(tempfile.gettempdir()) if parent is None else parent
    _remove_abandoned(place)
    folder, descriptor = _locked_folder(place)
    try:
        yield folder
    finally:
        os.close(descriptor)  # Windows removes no open file
        shutil.rmtree(folder, ignore_errors=True)


def _prefix() -> str:
    """Return how the names of this machine's folders begin.

    Some network file systems do not pass on locks, so a process of another machine would seem to be gone.
    """
    return f"symolo-{hashlib.sha256(platform.node().encode()).hexdigest()[:8]}-"


def _locked_folder(place: Path) -> tuple[Path, int]:
    """Return a new folder, and the descriptor that holds its lock."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=_prefix(), dir=place))
        try:
            descriptor = opened_lock(folder, OWNER)
        except OSError:  # a folder without this file would never be removed
            shutil.rmtree(folder, ignore_errors=True)
            raise
        with contextlib.suppress(OSError):  # a file system without locks, on which nobody removes abandoned folders
            lock(descriptor)
        # Another process may have held the lock since its file was made, and have removed the folder.
        if (folder / OWNER).exists():
            return folder, descriptor
        os.close(descriptor)


@cache
def _remove_abandoned(place: Path) -> None:
    """Remove the folders of this user and machine whose process is gone; once per process, for it reads all names."""
    if not can_lock():
        return
    with contextlib.suppress(OSError):  # a folder that cannot be listed
        for folder in place.glob(f"{_prefix()}*"):
            with contextlib.suppress(OSError):  # in use, already removed, or of a version that locked nothing
                _remove_if_abandoned(folder)


def _remove_if_abandoned(folder: Path) -> None:
    """Remove a folder, or raise an `OSError` where it is not certain that nobody uses it."""
    status = folder.lstat()
    is_own = not hasattr(os, "getuid") or status.st_uid == os.getuid()
    if not (is_own and stat.S_ISDIR(status.st_mode) and (folder / OWNER).is_file()):
        return
    descriptor = opened_lock(folder, OWNER)
    try:
        lock(descriptor, wait=False)
        # The lock goes last, so that the next command continues a removal that is killed half-way.
        for path in folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            elif path.name != OWNER:
                path.unlink()
        with contextlib.suppress(PermissionError):  # Windows removes no open file
            (folder / OWNER).unlink()
    finally:
        os.close(descriptor)
    shutil.rmtree(folder)
