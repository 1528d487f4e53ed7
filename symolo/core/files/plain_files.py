"""Reading of every file of a dataset: only plain files, no larger than files of their kind are.

A dataset may come from a stranger. A pipe or a device in the place of a file would make a reader wait for ever or fill
the memory, and a link would make it read a file of the user. An architecture test checks that no file of a dataset
is opened in another way. The text of an error never contains bytes of the file.

Only what lies inside a dataset must be plain: the path that leads to it, which the user names, may contain links.
Nobody is expected to exchange files while a command reads them.
"""

import os
import stat
from enum import Enum
from pathlib import Path
from typing import BinaryIO

from symolo.core.errors import InputError

_MIB = 1 << 20
_NO_LINK = getattr(os, "O_NOFOLLOW", 0)
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
"""Without `O_NONBLOCK` the system waits at a pipe until somebody writes. Windows lacks it and has no such pipes; there
`O_BINARY` keeps line ends as they are."""
_CURE = "put the file itself in its place, or take a dataset that you trust"


class FileKind(Enum):
    """Kinds of files, each with its name in messages and the number of bytes that one may have at most."""

    DOCUMENT = "a document", 64 * _MIB
    """metadata.json, spec.json, intrinsics.json, README.md and the like; 1,000 runs make 6 MB of metadata."""
    CHECKSUMS = "a list of checksums", 256 * _MIB
    TABLE = "a table", 512 * _MIB
    IMAGE = "an image", 64 * _MIB
    ANNOTATIONS = "a list of annotations", 256 * _MIB
    JOB = "a render job", 512 * _MIB
    """A render job, or the journal of its frames."""
    TRAJECTORY = "a trajectory", 384 * _MIB
    """Packed or not; 13 hours at 20 rows a second, or 2.8 hours of a robot with one sensor of every kind."""
    LOG = "a log", 100_000_000
    CODE = "a Python file", _MIB
    BAG = "a bag", 1 << 39
    """Read by a child with limits of its own."""
    ANY = "a file of a dataset", 512 * _MIB
    """A file that is copied as it is."""

    def __init__(self, title: str, max_bytes: int) -> None:
        self.title = title
        self.max_bytes = max_bytes


class UnsafeFileError(InputError, OSError):
    """A file that is not read, because it is not plain or is too large.

    It is an `InputError`, so that a command ends with one line, and an `OSError`, so that whoever reports a file that
    the disk does not give reports this one in the same way, by `strerror`.
    """

    def __init__(self, path: Path, what: str) -> None:
        super().__init__(what, where=str(path), cure=_CURE)
        self.filename = str(path)
        self.problem = what
        """What is wrong, without the place, beginning with `is`."""
        self.strerror = f"it {what}"

    def __reduce__(self) -> tuple[type["UnsafeFileError"], tuple[Path, str]]:
        """Come out of a worker process unchanged."""
        return UnsafeFileError, (Path(self.filename), self.problem)

    def __str__(self) -> str:
        """Return the line of the `InputError`, not that which an `OSError` makes of number and text."""
        return Exception.__str__(self)


def read_file(path: Path, kind: FileKind) -> bytes:
    """Return the bytes of a file of a dataset.

    Raises:
        UnsafeFileError: It is no plain file, or larger than its kind may be.
        OSError: It is missing, or the disk does not give it.
    """
    return _read(path, kind, may_be_link=False)


def read_named_file(path: Path, kind: FileKind) -> bytes:
    """Return the bytes of a file that the user has named, which may be a link to one.

    Raises:
        UnsafeFileError: It is no plain file, or larger than its kind may be.
        OSError: It is missing, or the disk does not give it.
    """
    return _read(path, kind, may_be_link=True)


def open_file(path: Path, kind: FileKind | None = None) -> BinaryIO:
    """Open a file of a dataset, to be read in blocks; without a kind it may have any size.

    Raises:
        UnsafeFileError: It is no plain file, or larger than its kind may be.
        OSError: It is missing, or the disk does not give it.
    """
    return _opened(path, kind, may_be_link=False)


def open_named_file(path: Path) -> BinaryIO:
    """Open a file that the user has named, which may be a link to one; errors are those of `open_file`."""
    return _opened(path, None, may_be_link=True)


def is_plain_file(path: Path) -> bool:
    """Return whether there is a file, and no link to one."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except (OSError, ValueError):
        return False


def check_folders(root: Path, name: str) -> None:
    """Refuse a run that is reached through a link, or whose own folders are links.

    Args:
        root: The dataset, which may itself lie below a link.
        name: Path of the run within it; empty where the run is the dataset.

    Raises:
        UnsafeFileError: A folder is a link; it names the first one.
    """
    run = root / name
    _check_way(root, run)
    for folder in (*_folders(run), *_folders(run / "annotations")):
        _check_no_link(folder)


def check_tree(root: Path, name: str) -> None:
    """Refuse a folder that is reached through a link, or with a link to a folder at any depth; one may be missing.

    Args:
        root: The dataset, which may itself lie below a link.
        name: Path of the folder within it.

    Raises:
        UnsafeFileError: A folder is a link; it names the first one.
    """
    _check_way(root, root / name)
    for place, names, _ in os.walk(root / name):
        for folder in sorted(names):
            _check_no_link(Path(place, folder))


def _check_way(root: Path, folder: Path) -> None:
    for above in reversed([above for above in (folder, *folder.parents) if root in above.parents]):
        _check_no_link(above)


def _folders(place: Path) -> list[Path]:
    try:
        return sorted(path for path in place.iterdir() if path.is_dir())
    except OSError:
        return []


def _check_no_link(path: Path) -> None:
    if path.is_symlink():
        raise UnsafeFileError(path, "is a symbolic link, and a dataset holds plain folders")


def _read(path: Path, kind: FileKind, *, may_be_link: bool) -> bytes:
    with _opened(path, kind, may_be_link=may_be_link) as file:
        return file.read(os.fstat(file.fileno()).st_size)  # and no more, of a journal that grows meanwhile


def _opened(path: Path, kind: FileKind | None, *, may_be_link: bool) -> BinaryIO:
    """Open a plain file; a device is not even opened, because that alone may do something."""
    _check_plain(path, path.stat() if may_be_link else path.lstat())
    descriptor = os.open(path, _FLAGS | (0 if may_be_link else _NO_LINK))
    try:
        _check_plain(path, os.fstat(descriptor), kind)
        return open(descriptor, "rb")  # noqa: PTH123 - a descriptor, which has no path
    except BaseException:
        os.close(descriptor)
        raise


def _check_plain(path: Path, status: os.stat_result, kind: FileKind | None = None) -> None:
    if stat.S_ISREG(status.st_mode):
        if kind is not None and status.st_size > kind.max_bytes:
            raise UnsafeFileError(path, f"is larger than {kind.max_bytes // _MIB} MiB, which {kind.title} never is")
        return
    kinds = {
        stat.S_IFLNK: "a symbolic link",
        stat.S_IFDIR: "a folder",
        stat.S_IFIFO: "a pipe",
        stat.S_IFSOCK: "a socket",
    }
    raise UnsafeFileError(
        path, f"is {kinds.get(stat.S_IFMT(status.st_mode), 'a device')}, and a dataset holds plain files"
    )
