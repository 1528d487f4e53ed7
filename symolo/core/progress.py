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

    def fail(self, number: int) -> None:
        """Report, before the end of the stage, how many of its parts ended with a problem."""
        ...


class Report(Protocol):
    """Receiver of the reports of a command's stages."""

    def stage(self, name: str, total: float, unit: str, *, is_even: bool = True) -> AbstractContextManager[StageReport]:
        """Return the receiver of a stage's progress.

        Args:
            name: Name of the stage.
            total: All that there is to do, in `unit`.
            unit: Noun for what is counted, in the plural.
            is_even: Whether each part advances so evenly that the time left follows from it. Otherwise only parts that
                are done say something about it.
        """
        ...

    def say(self, text: str) -> None: ...


def report_here() -> Report:
    return BarReport() if sys.stderr.isatty() else LineReport()


class LineReport:
    """Plain lines, one at the start and end of a stage and now and then between."""

    def say(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)  # noqa: T201 - this is the log of a batch

    @contextmanager
    def stage(self, name: str, total: float, unit: str, *, is_even: bool = True) -> Iterator[StageReport]:
        unit = _counted(unit, total)
        stage = _Lines(self, name, total, unit, _Clock(total, is_even=is_even))
        yield stage
        failed = f"; {stage.failed} failed" if stage.failed else ""
        self.say(f"{name}: {stage.done:.0f} of {total:.0f} {unit} in {seconds(stage.clock.passed_s)}{failed}")


class _Clock:
    """Estimate of the time left of a stage from its parts."""

    def __init__(self, total: float, *, is_even: bool) -> None:
        self._total, self._is_even = total, is_even
        self._parts: dict[str, float] = {}
        self._started = time.monotonic()
        self._whole, self._whole_after_s = 0.0, 0.0

    @property
    def done(self) -> float:
        return sum(self._parts.values())

    @property
    def passed_s(self) -> float:
        """Time since the stage began."""
        return time.monotonic() - self._started

    def update(self, name: str, done: float) -> None:
        """Note how much of the part `name` is done."""
        self._parts[name] = done
        whole = sum(part for part in self._parts.values() if part >= 1.0)
        if whole > self._whole:
            self._whole, self._whole_after_s = whole, self.passed_s

    @property
    def estimate(self) -> str:
        """The estimated time left, such as `8.0 s`; empty if all is done, or if there is no estimate."""
        if self._is_even:
            return time_left(self.passed_s, self.done / self._total if self._total else 1.0)
        if self.done >= self._total or not self._whole:
            return ""
        # The end is expected at a fixed time from one finished part to the next, so that the time left falls.
        left_s = self._whole_after_s * self._total / self._whole - self.passed_s
        return seconds(left_s) if left_s > 0.0 else ""

    @property
    def left(self) -> str:
        """The time left as text; empty if all is done, or if it is too early to estimate."""
        if estimate := self.estimate:
            return f"about {estimate} left"
        return "" if self._is_even or self.done >= self._total else "time left not known"


class _Lines:
    def __init__(self, report: LineReport, name: str, total: float, unit: str, clock: _Clock) -> None:
        self._report, self._name, self._total, self._unit, self.clock = report, name, total, unit, clock
        self._last, self._text = time.monotonic(), ""
        self.failed = 0

    @property
    def done(self) -> float:
        return self.clock.done

    def say(self, text: str) -> None:
        self._report.say(f"{self._name}: {text}")

    def fail(self, number: int) -> None:
        self.failed = number

    def update(self, name: str, done: float) -> None:
        self.clock.update(name, done)
        now = time.monotonic()
        # The line at the end of the stage says that all is done.
        if now - self._last < SECONDS_BETWEEN_LINES or self.done >= self._total:
            return
        self._last = now
        if not math.floor(self.done) and self._total <= 1.0 and not self.clock.estimate:
            return  # "0 of 1" says nothing
        left = self.clock.left
        text = f"{math.floor(self.done)} of {self._total:.0f} {self._unit}{left and f', {left}'}"
        if text != self._text:  # the same line again says nothing
            self.say(text)
        self._text = text


class BarReport:
    """A bar per stage with elapsed and remaining time."""

    def __init__(self) -> None:
        from rich.console import Console  # noqa: PLC0415 - the help of a command needs no console

        self._console = Console(stderr=True, highlight=False)

    def say(self, text: str) -> None:
        self._console.print(text, markup=False)

    @contextmanager
    def stage(self, name: str, total: float, unit: str, *, is_even: bool = True) -> Iterator[StageReport]:
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

            def show(clock: _Clock, failed: int) -> None:
                progress.update(task, completed=clock.done, left=f"{failed} failed" if failed else clock.left)

            yield _Bar(_Clock(total, is_even=is_even), show, self.say)


class _Bar:
    def __init__(self, clock: _Clock, show: Callable[[_Clock, int], None], say: Callable[[str], None]) -> None:
        self._clock, self._show, self._say = clock, show, say

    def say(self, text: str) -> None:
        self._say(text)

    def update(self, name: str, done: float) -> None:
        self._clock.update(name, done)
        self._show(self._clock, 0)

    def fail(self, number: int) -> None:
        self._show(self._clock, number)


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
    """Return a duration in the usual units: `8.2 s`, `3 min 05 s`, `2 h 10 min`."""
    if duration_s < 60:
        return f"{duration_s:.1f} s"
    minutes, rest = divmod(round(duration_s), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def plural(number: int, noun: str, digits: Callable[[int], str] = str) -> str:
    """Return a number, written by `digits`, with its noun: `1 run`, `2 runs`, `0 runs`."""
    return f"{digits(number)} {noun}" if number == 1 else f"{digits(number)} {noun}s"
