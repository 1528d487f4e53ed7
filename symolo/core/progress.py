"""Progress of a command: a bar with the time left on a terminal, plain lines elsewhere; always on standard error."""

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol

SECONDS_BETWEEN_LINES = 10.0
MIN_SHARE = 0.02
"""Share of a stage that must be done before the time left is estimated from it."""


class StageReport(Protocol):
    """Receiver of the progress of one stage."""

    def update(self, name: str, done: float) -> None:
        """Report how much of the part `name` is done, in the unit of the stage."""
        ...

    def say(self, text: str) -> None:
        """Report a line that stays on the screen."""
        ...


class Report(Protocol):
    """Receiver of the reports of a command's stages."""

    def stage(self, name: str, total: float, unit: str) -> AbstractContextManager[StageReport]: ...

    def say(self, text: str) -> None: ...


def report_here() -> Report:
    return BarReport() if sys.stderr.isatty() else LineReport()


class LineReport:
    """Plain lines, one at the start and end of a stage and now and then between."""

    def say(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)  # noqa: T201 - this is the log of a batch

    @contextmanager
    def stage(self, name: str, total: float, unit: str) -> Iterator[StageReport]:
        unit = _counted(unit, total)
        stage = _Lines(self, name, total, unit)
        yield stage
        self.say(f"{name}: {stage.done:.0f} of {total:.0f} {unit} in {seconds(time.monotonic() - stage.started)}")


class _Lines:
    def __init__(self, report: LineReport, name: str, total: float, unit: str) -> None:
        self._report, self._name, self._total, self._unit = report, name, total, unit
        self._parts: dict[str, float] = {}
        self.started = self._last = time.monotonic()

    @property
    def done(self) -> float:
        return sum(self._parts.values())

    def say(self, text: str) -> None:
        self._report.say(f"{self._name}: {text}")

    def update(self, name: str, done: float) -> None:
        self._parts[name] = done
        now = time.monotonic()
        # The line at the end of the stage says that all is done.
        if now - self._last < SECONDS_BETWEEN_LINES or self.done >= self._total:
            return
        self._last = now
        left = time_left(now - self.started, self.done / self._total)
        eta = f", about {left} left" if left else ""
        self.say(f"{math.floor(self.done)} of {self._total:.0f} {self._unit}{eta}")


class BarReport:
    """A bar per stage with elapsed and remaining time."""

    def __init__(self) -> None:
        from rich.console import Console  # noqa: PLC0415 - the help of a command needs no console

        self._console = Console(stderr=True, highlight=False)

    def say(self, text: str) -> None:
        self._console.print(text, markup=False)

    @contextmanager
    def stage(self, name: str, total: float, unit: str) -> Iterator[StageReport]:
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415 - see above

        columns = (
            TextColumn(f"{name:9}"),
            BarColumn(),
            TextColumn(f"{{task.completed:.0f}} of {{task.total:.0f}} {_counted(unit, total)}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
        )
        with Progress(*columns, console=self._console) as progress:
            task = progress.add_task(name, total=total, left="")
            started = time.monotonic()

            def show(done: float) -> None:
                left = time_left(time.monotonic() - started, done / total if total else 1.0)
                progress.update(task, completed=done, left=left and f"about {left} left")

            yield _Bar(show, self.say)


class _Bar:
    def __init__(self, show, say) -> None:  # noqa: ANN001 - two callables of the line above
        self._show, self.say = show, say
        self._parts: dict[str, float] = {}

    def update(self, name: str, done: float) -> None:
        self._parts[name] = done
        self._show(sum(self._parts.values()))


def _counted(unit: str, total: float) -> str:
    """Return a unit such as `runs` for a total: `1 of 1 run`, `0 of 2 runs`."""
    return unit.removesuffix("s") if total == 1 else unit


def time_left(since_s: float, share: float) -> str:
    """Return the time left if the rest of a stage is as fast as its beginning; empty if too little or all is done.

    The time from the start counts, and not the speed of the last parts: until the first part a stage may need long.

    Args:
        since_s: Time since the stage began.
        share: Share of the stage that is done.
    """
    return seconds(since_s * (1.0 / share - 1.0)) if MIN_SHARE <= share < 1.0 else ""


def seconds(duration_s: float) -> str:
    """A duration as a person says it: `8.2 s`, `3 min 05 s`, `2 h 10 min`."""
    if duration_s < 60:
        return f"{duration_s:.1f} s"
    minutes, rest = divmod(round(duration_s), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def plural(number: int, noun: str, digits: Callable[[int], str] = str) -> str:
    """Return a number, written by `digits`, with its noun: `1 run`, `2 runs`, `0 runs`."""
    return f"{digits(number)} {noun}" if number == 1 else f"{digits(number)} {noun}s"
