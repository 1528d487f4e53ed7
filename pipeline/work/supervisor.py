"""The supervisor: units of work over long-lived child processes, one at a time in each of N slots.

A child that is killed, hangs or takes too much memory is replaced and its unit tried again; what fails again and again
is set aside, and the rest goes on.
"""

import os
import queue
import tempfile
import threading
import traceback
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from pipeline.work.units import AnyUnit, Failed, Finished, Progress
from pipeline.work.worker_process import COMMAND, SCRATCH, Limits, WorkerProcess
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.os_errors import lacking

SECONDS_BETWEEN_LOOKS = 0.2
AGAIN = frozenset({"killed", "engine"})
"""Kinds of failure that another try may mend."""
BY_LIMITS = Limits()


@dataclass(frozen=True)
class Retried:
    """A unit failed and is tried again."""

    text: str
    """What failed, why, and which try comes next."""


@dataclass(frozen=True)
class SetAside:
    """A part of a unit failed in every try, and the unit goes on without it."""

    text: str


AnyEvent = Progress | Finished | Failed | Retried | SetAside


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
    *,
    limits: Limits = BY_LIMITS,
    command: Sequence[str] = COMMAND,
    of_slots: Sequence[Mapping[str, str]] = (),
) -> list[UnitFailure]:
    """Do all units, at most `workers` at once, and return those that failed, as a whole or in part.

    Args:
        units: In the order in which they are started; the result must not depend on it.
        workers: Number of children at a time.
        on_event: Called in this thread for each thing that a worker says, with the unit as given.
        environment: Variables of the children beside those of this process.
        limits: Of each child, and of what is tried again.
        command: What a child runs; it is told units, and tells what comes of them, as `pipeline.work.worker_main` does.
        of_slots: Further variables, such as of a graphics card: dealt out in turn to the children at a time, and kept
            by the one that replaces another.

    Raises:
        EnvironmentLacking, InputError: As soon as one worker says so; it would hit every unit.
        WorkerError: After the other units are done.
    """
    with tempfile.TemporaryDirectory(prefix="symolo-", ignore_cleanup_errors=True) as scratch:
        variables = {**environment, "TMPDIR": scratch, SCRATCH: scratch}
        slots = _Slots(deque(_Try(unit, unit) for unit in units), variables, limits, command, of_slots or ({},))
        return _supervised(slots, units, workers, on_event)


def _supervised(
    slots: "_Slots", units: Sequence[AnyUnit], workers: int, on_event: Callable[[AnyUnit, AnyEvent], None]
) -> list[UnitFailure]:
    found = _Found()
    count = max(1, min(workers, len(units)))
    threads = [threading.Thread(target=slots.work, args=(slot,), daemon=True) for slot in range(count)]
    threads.append(threading.Thread(target=slots.watch, daemon=True))
    try:
        for thread in threads:
            thread.start()
        left = len(units)
        while left:
            unit, event = slots.events.get()
            on_event(unit, event)
            left -= isinstance(event, Finished | Failed)
            found.note(unit, event)
    finally:
        slots.stop()
        for thread in threads:
            if thread.is_alive():  # an interrupt may come before all of them are started
                thread.join()
        slots.close()
    if found.bugs:
        raise WorkerError("\n".join(found.bugs))
    return found.failures


@dataclass
class _Found:
    """What went wrong so far."""

    failures: list[UnitFailure] = field(default_factory=list)
    bugs: list[str] = field(default_factory=list)

    def note(self, unit: AnyUnit, event: AnyEvent) -> None:
        """Keep what fails one unit; raise what would fail every one."""
        if isinstance(event, SetAside):
            self.failures.append(UnitFailure(unit, event.text))
        if not isinstance(event, Failed):
            return
        if event.error == "environment":
            raise EnvironmentLacking(event.text)
        if event.error == "input":
            raise InputError(event.text)
        if event.error == "bug":
            self.bugs.append(f"{unit.name}: {event.text}")
        else:
            self.failures.append(UnitFailure(unit, event.text))


@dataclass
class _Try:
    """A unit on its way: what is left of it, and how often which of its parts has failed."""

    unit: AnyUnit
    left: AnyUnit
    failed: Counter[int | None] = field(default_factory=Counter)
    """By frame; None for what comes before the first and between two, which starts afresh with each that is begun."""
    at: int | None = None
    """The frame that is being made."""


@dataclass
class _Slots:
    """State shared by the threads, one of which stands behind each child."""

    waiting: deque[_Try]
    environment: Mapping[str, str]
    limits: Limits
    command: Sequence[str]
    of_slots: Sequence[Mapping[str, str]]
    events: "queue.SimpleQueue[tuple[AnyUnit, AnyEvent]]" = field(default_factory=queue.SimpleQueue)
    running: set[WorkerProcess] = field(default_factory=set)
    stopped: threading.Event = field(default_factory=threading.Event)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def work(self, slot: int) -> None:
        worker: WorkerProcess | None = None
        try:
            while (tried := self._next()) is not None:
                try:
                    worker = self._do(tried, worker, slot)
                except Exception as error:  # noqa: BLE001 - a thread must not end in silence: `run_units` waits
                    self.events.put((tried.unit, _supervisor_failed(error)))
        finally:
            if worker is not None:
                self._let_go(worker)

    def watch(self) -> None:
        """See to it that no child hangs or takes more than it may."""
        while not self.stopped.wait(SECONDS_BETWEEN_LOOKS):
            with self.lock:
                running = list(self.running)
            for worker in running:
                worker.watch(self.limits)

    def stop(self) -> None:
        """Start nothing more and end what runs, whole process groups at once."""
        with self.lock:
            self.waiting.clear()
            self.stopped.set()
            for worker in self.running:
                worker.end_group()

    def close(self) -> None:
        """Wait for what a thread that met a bug has left behind."""
        for worker in list(self.running):
            self._let_go(worker)

    def _next(self) -> _Try | None:
        with self.lock:
            return self.waiting.popleft() if self.waiting else None

    def _do(self, tried: _Try, worker: WorkerProcess | None, slot: int) -> WorkerProcess | None:
        """Try a unit until it is done or given up, in this worker or a new one; the worker for the next unit."""
        while True:
            if worker is None or not worker.alive or not tried.left.shares_a_worker:
                if worker is not None:
                    self._let_go(worker)
                worker = self._started(slot)
                if worker is None:
                    return None
            last = self._once(tried, worker)
            if not isinstance(last, Failed) or last.error not in AGAIN:
                self.events.put((tried.unit, last))
                return worker
            tried.left.clear(worker.writer)
            if self.stopped.is_set():
                return worker
            if (end := self._after(tried, last)) is not None:
                self.events.put((tried.unit, end))
                return worker

    def _started(self, slot: int) -> WorkerProcess | None:
        with self.lock:
            if self.stopped.is_set():
                return None
            own = self.of_slots[slot % len(self.of_slots)]
            worker = WorkerProcess({**self.environment, **own}, self.command)
            self.running.add(worker)
            return worker

    def _let_go(self, worker: WorkerProcess) -> None:
        worker.close()
        with self.lock:
            self.running.discard(worker)

    def _once(self, tried: _Try, worker: WorkerProcess) -> Finished | Failed:
        tried.at = None
        for message in worker.do(tried.left):
            if isinstance(message, Finished | Failed):
                return message
            if isinstance(message, Progress):
                if message.at is not None:
                    tried.failed[None] = 0
                tried.at = message.at
                self.events.put((tried.unit, message))
        raise AssertionError("a worker's words end with what came of the unit")

    def _after(self, tried: _Try, failed: Failed) -> Finished | Failed | None:
        """Count a failure: nothing where the unit is to be tried again, else what is to be said of it."""
        at = tried.at
        tried.failed[at] += 1
        count, most = tried.failed[at], self.limits.tries
        what = tried.unit.name if at is None else f"{tried.unit.name}, image {at}"
        if count < most:
            self.events.put((tried.unit, Retried(f"{what}: {failed.text}; trying again ({count + 1} of {most})")))
            return None
        if at is None:
            return Failed(
                error=failed.error, text=f"given up after {most} tries; the same command tries it again: {failed.text}"
            )
        self.events.put((tried.unit, SetAside(tried.left.given_up(at, most, failed.text))))
        rest = tried.left.without(at)
        if rest is None:
            return Finished()
        tried.left = rest
        return None


def _supervisor_failed(error: Exception) -> Failed:
    told = lacking(error)
    return Failed(error="environment", text=told) if told else Failed(error="bug", text=traceback.format_exc())
