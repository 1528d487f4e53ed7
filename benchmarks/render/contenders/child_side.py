"""The common part of all processes that render for a benchmark: they receive numbers of frames and reply their cost.

A process gets the files of its job and settings, a folder and a number of threads. It writes one line once it is ready
and one for each line that it receives; the output of Blender goes to the standard error.
"""

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from blender_scenes.render.job import RenderJob


@dataclass(frozen=True)
class ProcessArguments:
    """The arguments of a process that renders."""

    job: RenderJob
    settings: dict[str, Any]
    folder: Path
    threads: int

    @classmethod
    def from_arguments(cls, arguments: Sequence[str]) -> "ProcessArguments":
        job, settings, folder, threads = arguments
        return cls(RenderJob.from_json(Path(job).read_text()), json.loads(settings), Path(folder), int(threads))


RenderFrames = Callable[[Sequence[int], bool], dict[int, np.ndarray]]
"""Function of the numbers of frames, and of whether they only warm up. It returns the linear light (H, W, 3) of each
frame, or several passes (passes, H, W, 3)."""


def reply_stream() -> TextIO:
    """Return the standard output for replies alone; call it before Blender is loaded."""
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    return replies


def serve(replies: TextIO, folder: Path, render: RenderFrames) -> None:
    """Answer requests until the input ends; images are left as NUMBER.npy, which is not timed."""
    _reply(replies, time.process_time(), 0.0)
    for line in sys.stdin:
        request = json.loads(line)
        wall, core = time.perf_counter(), time.process_time()
        seen = render(request["numbers"], request["warm_up"])
        wall, core = time.perf_counter() - wall, time.process_time() - core
        for number, light in seen.items():
            np.save(folder / f"{number}.npy", light)
        _reply(replies, core, wall)


def _reply(replies: TextIO, core_s: float, wall_s: float) -> None:
    replies.write(json.dumps({"core_s": core_s, "wall_s": wall_s}) + "\n")
