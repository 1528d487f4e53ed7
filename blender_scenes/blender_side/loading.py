"""Blender loaded with no more threads than it is to render with."""

import contextlib
import os
from pathlib import Path


def load_bpy(threads: int) -> None:
    """Import bpy; the process may use the same cores before and after.

    Its task scheduler, oneTBB, makes a pool for all cores that the process may use when it is loaded. Cycles then lets
    in as many threads as it is told to use, and one that is kept out asks for work without end (`sched_yield`), which
    took 0.7 of a core from the others.

    Raises:
        ImportError: bpy, or a library that it needs, is not there.
    """
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(cores)[:threads])
    try:
        import bpy  # noqa: F401, PLC0415 - the moment matters
    finally:
        for task in Path("/proc/self/task").iterdir():  # what the libraries have started meanwhile too
            with contextlib.suppress(ProcessLookupError):  # one that has just ended
                os.sched_setaffinity(int(task.name), cores)
