"""Whether another command works in an output folder, by the lock that it holds there."""

import fcntl
import os
from dataclasses import dataclass
from pathlib import Path

from pipeline.run_folder.workspace import Workspace
from symolo.core.files.file_locks import LOCK
from symolo.dataset.layout import STAGES


@dataclass(frozen=True)
class Worker:
    """Whether another command works in the folder."""

    is_working: bool
    process: int = 0
    """Number of its process; 0 where it is not known."""
    has_stages: bool = True
    """Whether there is a `.stages`, without which the next release makes everything again."""


def worker_of(workspace: Workspace) -> Worker:
    """Return whether another command works in the folder, by its lock, which is released at once."""
    try:
        descriptor = os.open(workspace.out / STAGES / LOCK, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:
        return Worker(is_working=False, has_stages=(workspace.out / STAGES).is_dir())
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return Worker(is_working=True, process=_holder(os.fstat(descriptor)))
    else:
        return Worker(is_working=False)
    finally:
        os.close(descriptor)


def _holder(place: os.stat_result) -> int:
    """Return the process that holds the lock, by /proc/locks of Linux (proc(5)); 0 where that is unknown."""
    where = f"{os.major(place.st_dev):02x}:{os.minor(place.st_dev):02x}:{place.st_ino}"
    try:
        lines = Path("/proc/locks").read_text(encoding="ascii").splitlines()
    except (OSError, ValueError):
        return 0
    rows = [line.split() for line in lines]
    return next((int(row[4]) for row in rows if row[1:2] == ["FLOCK"] and row[5:6] == [where]), 0)
