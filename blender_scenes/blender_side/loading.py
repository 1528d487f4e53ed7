"""Import of Blender with a limited number of threads."""

import contextlib
import os
from pathlib import Path


def load_bpy(threads: int) -> None:
    """Import bpy while the process is limited to so many cores.

    Its task scheduler, oneTBB, creates a thread for each core that the process may use at the time of the import.
    Cycles later admits only its own number of threads, and another thread that waits for admission polls
    (`sched_yield`), which took 0.7 of a core from the others.

    Raises:
        ImportError: bpy or a library that it needs is missing.
    """
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(cores)[:threads])
    try:
        import bpy  # noqa: F401, PLC0415 - the moment matters
    finally:
        for task in Path("/proc/self/task").iterdir():  # includes the threads that the libraries have started
            with contextlib.suppress(ProcessLookupError):  # one that has just ended
                os.sched_setaffinity(int(task.name), cores)
