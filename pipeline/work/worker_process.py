"""One long-lived child process that does units of work, as the supervisor sees it.

It leads a process group of its own, so that ending it ends the renderer that it started.
"""

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from blender_scenes.render.surroundings import without_blender_settings
from pipeline import user_files
from pipeline.work.units import EVENTS, Alive, AnyMessage, AnyUnit, Failed, Finished
from symolo.core.atomic_files import WRITER, new_writer

COMMAND = (sys.executable, "-m", "pipeline.work.worker_main")
SCRATCH = "SYMOLO_SCRATCH"
"""Variable that names the folder for temporary files of all workers; whoever is left removes it."""


@dataclass(frozen=True)
class Limits:
    """What a worker may take before it is ended and its unit tried again."""

    tries: int = 3
    """How often a unit, or a frame of it, is tried before it is given up."""
    silence_s: float = 120.0
    """Without a sign of life, of which a worker gives one every few seconds."""
    memory_bytes: int = 0
    """Resident memory of a worker with the processes that it started; 0 for no limit."""


GB = 1e9
SHARE_OF_THE_MACHINE = 0.9
CONTROL_GROUP = Path("/sys/fs/cgroup/memory.max")


def limits_of(memory_gb: float | None) -> Limits:
    """With so much memory for a worker; None for what keeps the machine itself from running out of it."""
    if memory_gb is not None:
        return Limits(memory_bytes=int(memory_gb * GB))
    there = os.sysconf("SC_PAGESIZE") * os.sysconf("SC_PHYS_PAGES")
    with contextlib.suppress(OSError, ValueError):  # "max", or no such group
        there = min(there, int(CONTROL_GROUP.read_text(encoding="ascii")))
    return Limits(memory_bytes=int(SHARE_OF_THE_MACHINE * there))


class WorkerProcess:
    """Started at once; `close` or `end` ends it."""

    def __init__(self, environment: Mapping[str, str], command: Sequence[str] = COMMAND) -> None:
        self.writer = new_writer()
        """Of all that it and its children leave unfinished."""
        self._log = tempfile.TemporaryFile("a+b")  # noqa: SIM115 - lives as long as the process
        self._ended_for = ""
        self._lock = threading.Lock()
        self._over = False
        self._heard_s = self._moved_s = time.monotonic()
        self._patience_s = 0.0
        self._busy = False
        self._child = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            start_new_session=True,
            # Safe path, for a folder `configs` where the user stands is not ours.
            env={
                **without_blender_settings(os.environ),
                "PYTHONSAFEPATH": "1",
                WRITER: self.writer,
                **user_files.environment(),
                **environment,
            },
        )

    def do(self, unit: AnyUnit) -> Iterator[AnyMessage]:
        """What the worker says of a unit, up to `Finished` or `Failed`; its death is a `Failed` of kind `killed`."""
        self._log.truncate(0)
        self._heard_s = self._moved_s = time.monotonic()
        self._patience_s = unit.patience_s
        self._busy = True
        assert self._child.stdin is not None and self._child.stdout is not None  # noqa: S101, PT018 - both are pipes
        with contextlib.suppress(BrokenPipeError):  # killed already, as is noticed when it is listened to
            self._child.stdin.write(unit.model_dump_json().encode() + b"\n")
            self._child.stdin.flush()
        for line in self._child.stdout:
            self._heard_s = time.monotonic()
            with contextlib.suppress(ValidationError):
                message = EVENTS.validate_json(line)
                if isinstance(message, Alive):
                    continue
                self._moved_s = self._heard_s
                self._busy = not isinstance(message, Finished | Failed)
                yield message
                if not self._busy:
                    return
        self.end()
        self._busy = False
        yield Failed(error="killed", text=self._post_mortem())

    @property
    def alive(self) -> bool:
        return not self._over

    def watch(self, limits: Limits) -> None:
        """End it if it is silent, gets no further or takes too much memory; called by another thread now and then."""
        now = time.monotonic()
        if self._over or not self._busy:
            return
        if now - self._heard_s > limits.silence_s:
            self._end_for(f"it gave no sign of life for {limits.silence_s:g} s")
        elif now - self._moved_s > self._patience_s:
            self._end_for(f"it got no further in {self._patience_s:g} s")
        elif limits.memory_bytes and (taken := memory_of(self._child.pid)) > limits.memory_bytes:
            self._end_for(f"it took {taken / GB:.2f} GB of memory, and {limits.memory_bytes / GB:.2f} GB are allowed")

    def _end_for(self, reason: str) -> None:
        self._ended_for = reason
        self.end_group()

    def end_group(self) -> None:
        """Kill it with all that it started; may be called by any thread, at any time."""
        with self._lock:
            # Before the leader is waited for its number cannot be another's.
            if not self._over:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(self._child.pid, signal.SIGKILL)

    def end(self) -> None:
        """Kill it and wait for it."""
        self.end_group()
        with self._lock:
            self._over = True
        with contextlib.suppress(BrokenPipeError), self._child:  # it did not read all that it was told
            pass

    def close(self) -> None:
        """End it, and let go of its log."""
        self.end()
        self._log.close()

    def _post_mortem(self) -> str:
        self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, self._log.tell() - 2000))
        tail = self._log.read().decode("utf-8", errors="replace").strip().splitlines()
        last = f"; its last line: {tail[-1]}" if tail else ""
        if self._ended_for:
            return f"the worker was ended, for {self._ended_for}{last}"
        code = self._child.returncode
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        cause = " (out of memory?)" if code == -signal.SIGKILL else ""
        return f"the worker was ended by {how}{cause}{last}"


def memory_of(process: int) -> int:
    """Resident memory [bytes] of a process and all that it started; what they share counts for each."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1])
        children = [
            int(child)
            for task in Path(f"/proc/{process}/task").iterdir()
            for child in (task / "children").read_text(encoding="ascii").split()
        ]
    except (OSError, IndexError):  # it has just ended
        return 0
    return pages * os.sysconf("SC_PAGESIZE") + sum(map(memory_of, children))
