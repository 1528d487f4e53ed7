"""The supervisor: units of work over long-lived child processes, one unit at a time in each of N slots.

A child that is killed, hangs or uses too much memory is replaced and its unit is tried again. A frame that fails in
every try is given up, and the rest goes on.
"""

import os
import queue
import threading
import traceback
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from pipeline.work.units import AnyUnit, Progress
from pipeline.work.worker_process import COMMAND, WorkerLimits, WorkerProcess
from symolo.core.child_process import SCRATCH, Failed, Finished
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.os_errors import lacking

WORTH_ANOTHER_TRY = frozenset({"killed", "engine"})
"""Kinds of failure after which another try may succeed."""
DEFAULT_LIMITS = WorkerLimits()


@dataclass(frozen=True)
class Retried:
    """A unit failed and is tried again."""

    text: str
    """Message with the unit, the cause of the failure and the number of the next try."""


@dataclass(frozen=True)
class FrameGivenUp:
    """A frame failed in every try, and its unit goes on without it."""

    text: str


AnyEvent = Progress | Finished | Failed | Retried | FrameGivenUp


class WorkerError(Exception):
    """A worker met a bug; the text is its traceback."""


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True)
class UnitFailure:
    """A unit that failed, as a whole or in part."""

    unit: AnyUnit
    text: str


def run_units(
    units: Sequence[AnyUnit],
    workers: int,
    on_event: Callable[[AnyUnit, AnyEvent], None],
    environment: Mapping[str, str] = MappingProxyType({}),
    *,
    limits: WorkerLimits = DEFAULT_LIMITS,
    command: Sequence[str] = COMMAND,
    slot_environments: Sequence[Mapping[str, str]] = (),
) -> list[UnitFailure]:
    """Do all units, at most `workers` at once, and return those that failed, as a whole or in part.

    Args:
        units: Units in the order in which they are started; the result must not depend on it.
        workers: Number of children at a time.
        on_event: Called in this thread for each message of a worker, with the unit as passed in `units`.
        environment: Environment variables of the children in addition to those of this process.
        limits: Limits for each child and number of tries.
        command: Command of a child, which must follow the protocol of `pipeline.work.worker_main`.
        slot_environments: Further variables, such as that of a graphics card. They are dealt out in turn to the slots;
            a child that replaces another one keeps its slot.

    Raises:
        EnvironmentLacking, InputError: As soon as one worker reports it, because it would hit every unit.
        WorkerError: A worker met a bug; raised after the other units are done.
    """
    with scratch_folder() as scratch:
        variables = {**environment, "TMPDIR": str(scratch), SCRATCH: str(scratch)}
        attempts = deque(_Attempt(unit, unit) for unit in units)
        slots = _Slots(attempts, variables, limits, command, slot_environments or ({},))
        return _supervise(slots, units, workers, on_event)


def _supervise(
    slots: "_Slots", units: Sequence[AnyUnit], workers: int, on_event: Callable[[AnyUnit, AnyEvent], None]
) -> list[UnitFailure]:
    failures: list[UnitFailure] = []
    bugs: list[str] = []
    count = max(1, min(workers, len(units)))
    threads = [threading.Thread(target=slots.work, args=(slot,), daemon=True) for slot in range(count)]
    try:
        for thread in threads:
            thread.start()
        left = len(units)
        while left:
            unit, event = slots.events.get()
            on_event(unit, event)
            left -= isinstance(event, Finished | Failed)
            if isinstance(event, Failed) and event.error == "environment":
                raise EnvironmentLacking(event.text)
            if isinstance(event, Failed) and event.error == "input":
                raise InputError(event.text)
            if isinstance(event, Failed) and event.error == "bug":
                bugs.append(f"{unit.name}: {event.text}")
            elif isinstance(event, Failed | FrameGivenUp):
                failures.append(UnitFailure(unit, event.text))
    finally:
        slots.stop()
        for thread in threads:
            if thread.is_alive():  # an interrupt may come before all of them are started
                thread.join()
        slots.close()
    if bugs:
        raise WorkerError("\n".join(bugs))
    return failures


@dataclass
class _Attempt:
    """A unit under way: the rest of it that is to be done, and how often each of its frames has failed."""

    unit: AnyUnit
    left: AnyUnit
    failures: Counter[int | None] = field(default_factory=Counter)
    """Number of failures by frame. None stands for the time before the first frame and between two frames; its count
    starts again with each frame that is begun."""
    at: int | None = None
    """Number of the frame that is being made."""


@dataclass
class _Slots:
    """State shared by the threads, one of which stands behind each child."""

    waiting: deque[_Attempt]
    environment: Mapping[str, str]
    limits: WorkerLimits
    command: Sequence[str]
    slot_environments: Sequence[Mapping[str, str]]
    events: "queue.SimpleQueue[tuple[AnyUnit, AnyEvent]]" = field(default_factory=queue.SimpleQueue)
    running: set[WorkerProcess] = field(default_factory=set)
    stopped: threading.Event = field(default_factory=threading.Event)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def work(self, slot: int) -> None:
        """Do waiting units one after the other, until there are none."""
        worker: WorkerProcess | None = None
        try:
            while True:
                with self.lock:
                    attempt = self.waiting.popleft() if self.waiting else None
                if attempt is None:
                    break
                try:
                    worker = self._do(attempt, worker, slot)
                except Exception as error:  # noqa: BLE001 - a thread must not end in silence: `run_units` waits
                    cause = lacking(error)
                    failed = Failed(error="environment", text=cause) if cause else None
                    self.events.put((attempt.unit, failed or Failed(error="bug", text=traceback.format_exc())))
        finally:
            if worker is not None:
                self._release(worker)

    def stop(self) -> None:
        """Start nothing more, and kill all workers with their process groups."""
        with self.lock:
            self.waiting.clear()
            self.stopped.set()
            for worker in self.running:
                worker.kill()

    def close(self) -> None:
        """Wait for the workers that a thread with a bug has left behind."""
        for worker in list(self.running):
            self._release(worker)

    def _do(self, attempt: _Attempt, worker: WorkerProcess | None, slot: int) -> WorkerProcess | None:
        """Try a unit until it is done or given up, and return the worker for the next unit."""
        while True:
            if worker is None or not worker.alive or not attempt.left.shares_a_worker:
                if worker is not None:
                    self._release(worker)
                worker = self._start(slot)
                if worker is None:
                    return None
            end = self._try_once(attempt, worker)
            if isinstance(end, Failed) and end.error in WORTH_ANOTHER_TRY:
                attempt.left.clear(worker.writer)
                if self.stopped.is_set():
                    return worker
                end = self._after(attempt, end)
            if end is not None:
                self.events.put((attempt.unit, end))
                return worker

    def _start(self, slot: int) -> WorkerProcess | None:
        with self.lock:
            if self.stopped.is_set():
                return None
            slot_environment = self.slot_environments[slot % len(self.slot_environments)]
            worker = WorkerProcess({**self.environment, **slot_environment}, self.command)
            self.running.add(worker)
            return worker

    def _release(self, worker: WorkerProcess) -> None:
        worker.close()
        with self.lock:
            self.running.discard(worker)

    def _try_once(self, attempt: _Attempt, worker: WorkerProcess) -> Finished | Failed:
        attempt.at = None
        for message in worker.do(attempt.left, self.limits):
            if isinstance(message, Finished | Failed):
                return message
            if isinstance(message, Progress):
                if message.at is not None:
                    attempt.failures[None] = 0
                attempt.at = message.at
                self.events.put((attempt.unit, message))
        raise AssertionError("the messages about a unit end with Finished or Failed")

    def _after(self, attempt: _Attempt, failed: Failed) -> Finished | Failed | None:
        """Count a failure and return the end of the unit, or None where it is to be tried again."""
        at = attempt.at
        attempt.failures[at] += 1
        count, tries = attempt.failures[at], self.limits.tries
        name = attempt.unit.name if at is None else f"{attempt.unit.name}, image {at}"
        if count < tries:
            text = f"{name}: {failed.text}; trying again ({count + 1} of {tries})"
            self.events.put((attempt.unit, Retried(text)))
            return None
        if at is None:
            text = f"given up after {tries} tries; the same command tries it again: {failed.text}"
            return Failed(error=failed.error, text=text)
        self.events.put((attempt.unit, FrameGivenUp(attempt.left.given_up(at, tries, failed.text))))
        rest = attempt.left.without(at)
        if rest is None:
            return Finished()
        attempt.left = rest
        return None
