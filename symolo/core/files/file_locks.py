"""Locks on folders and journals, which the operating system releases however the process ends.

POSIX systems have `flock`, Windows has locks on a byte of a file. Where neither is, nothing is locked.
"""

import contextlib
import os
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from symolo.core.errors import InputError

LOCK = ".lock"
"""File in a folder that is locked; it stays, because removing it could remove the lock of another process."""


@cache
def _module(name: str) -> ModuleType | None:
    """Return a module of the standard library that only some systems have; None where it is missing."""
    try:
        return import_module(name)
    except ImportError:
        return None


def can_lock() -> bool:
    """Return whether this system has locks, so that the lack of one shows that nobody holds it."""
    return _module("fcntl") is not None or _module("msvcrt") is not None


def can_rename_locked() -> bool:
    """Return whether a locked file can be read and renamed; Windows permits neither."""
    return _module("fcntl") is not None


def lock(descriptor: int, *, shared: bool = False, wait: bool = True) -> None:
    """Lock an open file until its descriptor is closed.

    Args:
        descriptor: Open for writing.
        shared: Whether other shared locks may exist at the same time; Windows knows exclusive ones only.
        wait: Whether to wait for the process that holds the lock.

    Raises:
        BlockingIOError: Another process holds the lock, and `wait` is false.
    """
    if fcntl := _module("fcntl"):
        kind = fcntl.LOCK_SH if shared else fcntl.LOCK_EX
        fcntl.flock(descriptor, kind if wait else kind | fcntl.LOCK_NB)
    elif msvcrt := _module("msvcrt"):
        os.lseek(descriptor, 0, os.SEEK_SET)
        while True:
            try:
                msvcrt.locking(descriptor, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
            except OSError as error:
                if wait:  # LK_LOCK gives up after ten seconds
                    continue
                raise BlockingIOError(*error.args) from None
            return


def opened_lock(folder: Path, name: str = LOCK) -> int:
    """Return the descriptor of the file whose lock stands for that of a folder, wherever the folder is mounted.

    A lock on the folder itself is seen on one machine alone: clients of network file systems pass on locks of files,
    and exclusive ones only of files that are open for writing (flock(2), on NFS).
    """
    flags = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0)
    return os.open(folder / name, os.O_RDWR | os.O_CREAT | flags, 0o666)


def is_locked(folder: Path) -> bool:
    """Return whether another process has locked a folder for itself alone; nothing is written."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        descriptor = os.open(folder / LOCK, flags)
    except OSError:
        return False
    try:
        lock(descriptor, shared=True, wait=False)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Wait until no other process has locked a folder, and lock it; for work that takes moments."""
    descriptor = opened_lock(folder)
    try:
        lock(descriptor)
        yield
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def locked_or_refused(folder: Path, where: str) -> Iterator[None]:
    """Lock a folder for this process without writing a file into it.

    Raises:
        InputError: Another process has locked it, or has moved it since it was made.
    """
    can_open = hasattr(os, "O_DIRECTORY")
    beside = folder.with_name(f".{folder.name}{LOCK}")  # locked in place of a folder that cannot be opened
    try:
        flags = os.O_RDONLY | os.O_DIRECTORY if can_open else os.O_RDWR | os.O_CREAT
        descriptor = os.open(folder if can_open else beside, flags, 0o666)
    except FileNotFoundError:
        raise _refusal(where) from None
    try:
        lock_or_refuse(descriptor, where)
        # Between making and locking, the folder may have been moved by the process that held its lock.
        if not folder.is_dir() or (can_open and not os.path.samestat(os.fstat(descriptor), folder.stat())):
            raise _refusal(where)
        yield
    finally:
        os.close(descriptor)
        if not can_open:
            with contextlib.suppress(OSError):  # such a system removes no file that another process has open
                beside.unlink()


def lock_or_refuse(descriptor: int, where: str, *, shared: bool = False) -> None:
    """Lock an open file or folder without waiting.

    Raises:
        InputError: Another process has locked it.
    """
    try:
        lock(descriptor, shared=shared, wait=False)
    except BlockingIOError:
        raise _refusal(where) from None


def _refusal(where: str) -> InputError:
    what, cure = "another symolo command is working in this folder", "wait for it, or name another folder"
    return InputError(what, where=where, cure=cure)
