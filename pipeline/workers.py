"""The supervisor: units of work over spawned child processes, one at a time in each of N slots.

Each child leads a process group of its own, so that ending it ends the renderer that it started; a child that is killed
loses its own unit and no other.
"""

import contextlib
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import traceback
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import IO

from pydantic import ValidationError

from blender_scenes.surroundings import without_blender_settings
from configs.errors import EnvironmentLacking, InputError
from pipeline.units import EVENTS, AnyUnit, Failed, Finished, Progress

AnyEvent = Progress | Finished | Failed


class WorkerError(Exception):
    """A worker ended by an error that is not the user's; the text is its traceback."""


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True)
class UnitFailure:
    unit: AnyUnit
    text: str


def run_units(
    units: Sequence[AnyUnit],
    workers: int,
    on_event: Callable[[AnyUnit, AnyEvent], None],
    environment: Mapping[str, str] = MappingProxyType({}),
) -> list[UnitFailure]:
    """Do all units, at most `workers` at once, and return those that failed.

    Args:
        units: In the order in which they are started; the result must not depend on it.
        workers: Number of children at a time.
        on_event: Called in this thread for each thing that a worker says.
        environment: Variables of the children beside those of this process.

    Raises:
        EnvironmentLacking, InputError: As soon as one worker says so; it would hit every unit.
        WorkerError: After the other units are done.
    """
    slots = _Slots(deque(units), environment)
    failures: list[UnitFailure] = []
    bugs: list[str] = []
    threads = [threading.Thread(target=slots.work, daemon=True) for _ in range(max(1, min(workers, len(units))))]
    try:
        for thread in threads:
            thread.start()
        left = len(units)
        while left:
            unit, event = slots.events.get()
            on_event(unit, event)
            left -= not isinstance(event, Progress)
            if isinstance(event, Failed):
                if event.error == "environment":
                    raise EnvironmentLacking(event.text)
                if event.error == "input":
                    raise InputError(event.text)
                if event.error == "bug":
                    bugs.append(f"{unit.name}: {event.text}")
                else:
                    failures.append(UnitFailure(unit, event.text))
    finally:
        slots.stop()
        for thread in threads:
            if thread.is_alive():  # an interrupt may come before all of them are started
                thread.join()
    if bugs:
        raise WorkerError("\n".join(bugs))
    return failures


@dataclass
class _Slots:
    """State shared by the threads, one of which stands behind each running child."""

    waiting: deque[AnyUnit]
    environment: Mapping[str, str]
    events: "queue.SimpleQueue[tuple[AnyUnit, AnyEvent]]" = field(default_factory=queue.SimpleQueue)
    running: set[int] = field(default_factory=set)
    stopped: bool = False
    lock: threading.Lock = field(default_factory=threading.Lock)

    def work(self) -> None:
        while True:
            try:
                unit = self.waiting.popleft()
            except IndexError:
                return
            try:
                self._run(unit)
            except Exception:  # noqa: BLE001 - a thread must not end in silence, or `run_units` waits for ever
                self.events.put((unit, Failed(error="bug", text=traceback.format_exc())))

    def stop(self) -> None:
        """Start nothing more and end what runs, whole process groups at once."""
        self.waiting.clear()
        with self.lock:
            self.stopped = True
            for pid in self.running:
                end_group(pid)

    def _run(self, unit: AnyUnit) -> None:
        last: AnyEvent | None = None
        with tempfile.TemporaryFile() as log:
            with self.lock:
                if self.stopped:
                    return
                child = subprocess.Popen(
                    [sys.executable, "-m", "pipeline.worker_main"],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=log,
                    start_new_session=True,
                    # Safe path, for a folder `configs` where the user stands is not ours.
                    env={**without_blender_settings(os.environ), "PYTHONSAFEPATH": "1", **self.environment},
                )
                self.running.add(child.pid)
            with child:
                assert child.stdin is not None and child.stdout is not None  # noqa: S101, PT018 - both are pipes
                try:
                    child.stdin.write(unit.model_dump_json().encode() + b"\n")
                    child.stdin.flush()
                except BrokenPipeError:  # killed already; what is left in the buffer breaks once more when it is closed
                    with contextlib.suppress(BrokenPipeError):
                        child.stdin.close()
                for line in child.stdout:
                    with contextlib.suppress(ValidationError):
                        last = EVENTS.validate_json(line)
                        self.events.put((unit, last))
                # The worker has ended or is about to; a renderer may outlive one that was killed. The group is ended
                # before the leader is waited for, while its number cannot yet be another's.
                with self.lock:
                    self.running.discard(child.pid)
                    end_group(child.pid)
                child.wait()
            if not isinstance(last, Finished | Failed):
                self.events.put((unit, Failed(error="killed", text=_post_mortem(child.returncode, log))))


def end_group(leader: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(leader, signal.SIGKILL)


def _post_mortem(code: int, log: IO[bytes]) -> str:
    log.seek(0, os.SEEK_END)
    log.seek(max(0, log.tell() - 2000))
    tail = log.read().decode("utf-8", errors="replace").strip().splitlines()
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    cause = " (out of memory?)" if code == -signal.SIGKILL else ""
    return (
        f"the worker was ended by {how}{cause}{'; its last line: ' + tail[-1] if tail else ''}; run the command again"
    )
