"""Check that a path from the command line is possible, before any work starts."""

import errno
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path

from symolo.core.errors import InputError

TEMPORARY_CHARS = 24
"""Number of characters that the temporary name of a file or folder has in addition."""
BELOW_CHARS = 128
"""Longest path that is made inside an output folder."""
_REFUSALS = frozenset({errno.EROFS, errno.EACCES, errno.EPERM, errno.ENOENT})
"""Errors of a disk or a folder that takes no files, whatever is done about it before the next try; ENOENT is that of
/proc."""


def check_path(path: Path, where: str) -> None:
    """Refuse a path that the system or a file in UTF-8 cannot hold; a path at which there is nothing is accepted.

    Raises:
        InputError: It is not UTF-8, has a null character, is too long, a loop of links, or not accessible.
    """
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise InputError("is no valid UTF-8", where=where, got=str(path), cure="choose another name") from None
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        pass
    except ValueError:
        raise InputError("has a null character", where=where, got=str(path), cure="choose another name") from None
    except OSError as error:
        raise InputError(f"cannot be used: {error.strerror}", where=where, got=str(path)) from None


def check_folder(path: Path, cure: str, where: str = "") -> None:
    """Refuse a path that is not the path of a folder.

    Args:
        path: Path of the folder to read.
        cure: Advice on which folder to name instead.
        where: The path as the message names it; by default the path alone.

    Raises:
        InputError: There is nothing at the path, or a file.
    """
    if not path.is_dir():
        what = "is a file, not a folder" if path.exists() else "no such folder"
        raise InputError(what, where=where or str(path), cure=cure)


def check_new_path(path: Path, where: str, below_chars: int = 0) -> None:
    """Refuse what `check_path` refuses, and a path at which nothing could be made.

    Args:
        path: Path of the file or folder to be made.
        where: The option that holds it.
        below_chars: Length of what will be made inside.

    Raises:
        InputError: As `check_path`; a link that leads nowhere on the way, names too long for the disk, or a folder or
            disk that may not be written.
    """
    check_path(path, where)
    absolute = path.absolute()
    for part in (absolute, *absolute.parents):
        check_path(part, where)
        if part.is_symlink() and not part.exists():
            what = f"{part} is a link to something that is not there"
            raise InputError(what, where=where, cure="remove the link or choose another name")
    nearest = nearest_existing(absolute)
    name_max, path_max = _name_and_path_max(nearest)
    longest, whole = name_max - TEMPORARY_CHARS, path_max - TEMPORARY_CHARS - below_chars
    made = absolute.relative_to(nearest).parts
    if any(len(os.fsencode(name)) > longest for name in made) or len(os.fsencode(absolute)) > whole:
        raise InputError("is too long", where=where, got=str(path), cure="choose a shorter name")
    folder = nearest if nearest.is_dir() else nearest.parent
    error = writing_error(folder)
    if error is not None and error.errno in _REFUSALS:  # others, such as a full disk, have messages of their own
        raise not_writable(folder, error, f"{where} {path}")


def writing_error(folder: Path) -> OSError | None:
    """Return why no file can be made in a folder; None if one can."""
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        return error
    return None


def not_writable(folder: Path, error: OSError, where: str) -> InputError:
    """Return the error of an output that lies in a folder in which no file can be made."""
    return InputError(f"cannot be written: {folder}: {error.strerror}", where=where, cure="name a different folder")


def _name_and_path_max(folder: Path) -> tuple[int, int]:
    """Return the longest name and the longest path on a folder's disk, in bytes."""
    if not hasattr(os, "pathconf"):  # Windows without the setting for long paths
        return 255, 260
    return os.pathconf(folder, "PC_NAME_MAX"), os.pathconf(folder, "PC_PATH_MAX")


def nearest_existing(path: Path) -> Path:
    path = path.absolute()
    while not path.exists():
        path = path.parent
    return path


def folders_of(names: Iterable[str]) -> set[str]:
    """Return every folder, with its path, that lies on the way to files with these paths inside a top folder.

    A stranger's list may have a million of them, for which the parents of a `PurePath` take half a minute.
    """
    folders: set[str] = set()
    for name in names:
        folder = name.rpartition("/")[0]
        while folder and folder not in folders:  # what is there has brought its own parents
            folders.add(folder)
            folder = folder.rpartition("/")[0]
    return folders
