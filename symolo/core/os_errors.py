"""Meaning of an error of the operating system for the user: what the machine lacks, and what to do about it."""

import errno
import re
import sys

NOT_THERE = (FileNotFoundError, NotADirectoryError, IsADirectoryError)
"""Errors for a file that is not there. Any other error leaves open whether it is."""

_AGAIN = "run the same command again"
_CURES = {
    errno.ENOSPC: f"free some space and {_AGAIN}",
    errno.EDQUOT: f"remove files of yours on that disk or get a larger quota, and {_AGAIN}",
    errno.EFBIG: f"raise the limit on the size of files, such as by `ulimit -f unlimited`, and {_AGAIN}",
    **dict.fromkeys((errno.EACCES, errno.EPERM), f"allow this user to read and write there, and {_AGAIN}"),
    errno.EROFS: f"make the disk writable, or name a folder on another one, and {_AGAIN}",
    **dict.fromkeys(
        (errno.EIO, errno.ESTALE, errno.ENXIO, errno.ENODEV),
        f"the disk reports a fault: see what `dmesg` says of it, and {_AGAIN} or name a folder on another disk",
    ),
    errno.EMFILE: f"raise the limit of open files, such as by `ulimit -n 4096`, and {_AGAIN}",
    errno.ENFILE: f"close other programs, for the machine has too many files open, and {_AGAIN}",
    **dict.fromkeys(
        (errno.ENOMEM, errno.EAGAIN), f"free some memory, or take fewer --workers or smaller images, and {_AGAIN}"
    ),
}


_NO_MEMORY = re.compile(
    r"failed to map segment|cannot allocate memory|can't start new thread|insufficient memory|failed to allocate"
    r"|bad_alloc|out of memory|cannot apply additional memory protection",
    re.IGNORECASE,
)
"""Texts that the loader of libraries, Python's threads, OpenCV, Blender and C++ report in place of a MemoryError."""


def lacking(error: BaseException) -> str:
    """Return the error and its cure in one line; empty where the error is not the machine's."""
    shortage = _shortage_behind(error)
    if shortage is not None:
        reason = "".join(f": {line}" for line in str(shortage).strip().splitlines()[:1])
        return f"there is not enough memory{reason}; {_CURES[errno.ENOMEM]}"
    cure = _CURES.get(error.errno or 0, "") if isinstance(error, OSError) else ""
    if isinstance(error, FileNotFoundError) and "No usable temporary directory" in str(error):
        cure = f"free some space there or set TMPDIR, and {_AGAIN}"
    return f"{error}; {cure}" if cure else ""


def is_memory_limited() -> bool:
    """Return whether the process may address only so much memory; the system then refuses, and does not kill it."""
    if sys.platform == "win32":
        return False
    import resource  # noqa: PLC0415 - Windows has none

    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


def _shortage_behind(error: BaseException | None) -> BaseException | None:
    """Return the error of too little memory that this error is, or that kept a package from loading a library."""
    while error is not None:
        if isinstance(error, MemoryError) or (isinstance(error, Exception) and _NO_MEMORY.search(str(error))):
            return error
        if isinstance(error, SystemError) and is_memory_limited():  # Python 3.11 loses a MemoryError at some places
            return error
        error = (error.__cause__ or error.__context__) if isinstance(error, ImportError) else None
    return None
