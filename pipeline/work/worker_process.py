"""A long-lived child process that does units of work, as the supervisor sees it."""

import contextlib
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.render.surroundings import without_blender_settings
from pipeline import user_code
from pipeline.work.units import MESSAGES, AnyMessage, AnyUnit
from symolo.core.child_process import GB, SILENCE_S, ChildProcess, Failed
from symolo.core.files.atomic_files import WRITER, new_writer

COMMAND = (sys.executable, "-m", "pipeline.work.worker_main")
SHARE_OF_THE_MACHINE = 0.9
CONTROL_GROUP = Path("/sys/fs/cgroup/memory.max")


@dataclass(frozen=True)
class WorkerLimits:
    """What a worker may use before it is killed and its unit is tried again."""

    tries: int = 3
    """Number of tries of a unit, or of a frame of it, before it is given up."""
    silence_s: float = SILENCE_S
    """Time [s] without a sign of life, which a worker sends every few seconds."""
    memory_bytes: int = 0
    """Resident memory [byte] of a worker and its children; 0 for no limit."""


def limits_of(memory_gb: float | None) -> WorkerLimits:
    """Return limits with this memory for a worker; by default nine tenths of the machine's or control group's."""
    if memory_gb is not None:
        return WorkerLimits(memory_bytes=int(memory_gb * GB))
    total_bytes = os.sysconf("SC_PAGESIZE") * os.sysconf("SC_PHYS_PAGES")
    with contextlib.suppress(OSError, ValueError):  # "max", or no such group
        total_bytes = min(total_bytes, int(CONTROL_GROUP.read_text(encoding="ascii")))
    return WorkerLimits(memory_bytes=int(SHARE_OF_THE_MACHINE * total_bytes))


class WorkerProcess(ChildProcess[AnyMessage]):
    """A worker. It leads a process group, so that the renderer that it started ends with it."""

    def __init__(self, environment: Mapping[str, str], command: Sequence[str] = COMMAND) -> None:
        self.writer = new_writer()
        """Mark of all files that the worker and its children leave unfinished."""
        # The safe path keeps a folder `configs` in the user's working directory from being imported as ours.
        inherited = {**without_blender_settings(os.environ), "PYTHONSAFEPATH": "1", WRITER: self.writer}
        super().__init__(
            "the worker", command, MESSAGES, {**inherited, **user_code.environment(), **environment}, own_group=True
        )

    def do(self, unit: AnyUnit, limits: WorkerLimits) -> Iterator[AnyMessage]:
        """Yield the worker's messages about a unit, up to `Finished` or `Failed`."""
        for message in self.ask(
            unit, patience_s=unit.patience_s, silence_s=limits.silence_s, memory_bytes=limits.memory_bytes
        ):
            if isinstance(message, Failed) and message.error == "killed" and (last := self.last_lines(1)):
                yield message.model_copy(update={"text": f"{message.text}; its last line: {last[0]}"})
            else:
                yield message
