"""Blender's scheduler gets as many threads as Cycles, and the process its cores back."""

import os
import subprocess
import sys

import pytest

SCRIPT = """
import ctypes, os, sys
from importlib.util import find_spec
from pathlib import Path
from blender_scenes.blender_side.loading import load_bpy
lib = Path(find_spec("bpy").origin).parent / "lib"
load_bpy(int(sys.argv[1]))
tbb = ctypes.CDLL(str(next(lib.glob("libtbb.so.*"))))
# tbb::task_arena::max_concurrency of the arena that a thread of Blender's gets
threads = tbb._ZN3tbb6detail2r115max_concurrencyEPKNS0_2d115task_arena_baseE(None)
tasks = [int(task) for task in os.listdir("/proc/self/task")]
cores = {len(os.sched_getaffinity(task)) for task in tasks}
sys.stderr.write(f"\\nFOUND {threads} {cores}\\n")
"""


@pytest.mark.parametrize("threads", [1, 2, 64])
def test_the_scheduler_has_no_thread_that_is_kept_out(threads):
    cores = len(os.sched_getaffinity(0))
    ended = subprocess.run([sys.executable, "-c", SCRIPT, str(threads)], capture_output=True, text=True, check=True)
    assert f"FOUND {min(threads, cores)} {{{cores}}}" in ended.stderr.splitlines()
