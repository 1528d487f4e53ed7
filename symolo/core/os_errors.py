"""What a refusal of the operating system means for the user: what the machine lacks, and what mends it."""

import errno

DISK_FULL = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
"""EFBIG too: a limit on the size of files stops the writing of an image as a full disk does."""

NOT_THERE = (FileNotFoundError, NotADirectoryError, IsADirectoryError)
"""What is raised for a file that is not there. Any other error says nothing about whether it is."""

_AGAIN = "run the same command again"
_CURES = {
    **dict.fromkeys(DISK_FULL, f"free some space and {_AGAIN}"),
    **dict.fromkeys((errno.EACCES, errno.EPERM), f"allow this user to read and write there, and {_AGAIN}"),
    errno.EROFS: f"make the disk writable, or name a folder on another one, and {_AGAIN}",
    **dict.fromkeys(
        (errno.EIO, errno.ESTALE, errno.ENXIO, errno.ENODEV),
        f"the disk reports a fault: see what `dmesg` says of it, and {_AGAIN} or name a folder on another disk",
    ),
    errno.EMFILE: f"raise the limit of open files, such as by `ulimit -n 4096`, and {_AGAIN}",
    errno.ENFILE: f"close other programs, for the machine has too many files open, and {_AGAIN}",
    **dict.fromkeys((errno.ENOMEM, errno.EAGAIN), f"free some memory or name fewer --workers, and {_AGAIN}"),
}


def cure_of(error: BaseException) -> str:
    """What to do about an error that is the machine's; empty where it is none."""
    if isinstance(error, MemoryError):
        return _CURES[errno.ENOMEM]
    return _CURES.get(error.errno or 0, "") if isinstance(error, OSError) else ""


def lacking(error: BaseException) -> str:
    """The error and its cure in one line; empty where the error is not the machine's."""
    cure = cure_of(error)
    text = str(error) or "there is not enough memory"
    return f"{text}; {cure}" if cure else ""
