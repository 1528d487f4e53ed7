"""A child process that answers one line with one line, and what happens when it does not."""

import contextlib
import os
import select
import subprocess
import time
from collections.abc import Sequence

from symolo.core.errors import EnvironmentLacking, RunFailed, one_line

MAX_LINE_BYTES = 1 << 16
"""Longest answer; a command has less than 200 bytes."""
_LOG_BYTES = 2000
_END_S = 1.0
"""Time for a process to end by itself after its standard input was closed."""
_MAX_READ = 1 << 16


class Pipe:
    """A running process; `close` ends it. It runs in the group of this process, and ends with it."""

    def __init__(self, command: Sequence[str]) -> None:
        """Start the process.

        Raises:
            EnvironmentLacking: It cannot be started.
        """
        # Workers have the safe path of Python, with which a script could not import the files beside it.
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
        try:
            self._child = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
            )
        except OSError as error:
            raise EnvironmentLacking(f"the controller {command[0]} cannot be started: {error.strerror}") from None
        pipes = (self._child.stdin, self._child.stdout, self._child.stderr)
        self._pipes = tuple(pipe for pipe in pipes if pipe is not None)
        self._to, self._from, self._errors = (pipe.fileno() for pipe in self._pipes)
        os.set_blocking(self._to, False)
        self._answer = b""
        self._log = b""
        self._is_closed = False

    def ask(self, line: str, within_s: float, when: str) -> bytes:
        """Send a line and return the line that answers it, without its end.

        Args:
            line: Text without a line end.
            within_s: Longest time until the answer is complete.
            when: The moment, for messages.

        Raises:
            RunFailed: The process has ended, does not answer in time, or sends more than one line.
        """
        self._check_silent(when)
        deadline_s = time.monotonic() + within_s
        unsent = line.encode() + b"\n"
        while not self._answer.endswith(b"\n"):
            left_s = deadline_s - time.monotonic()
            readable, writable, _ = select.select(
                [self._from, self._errors] if self._errors >= 0 else [self._from],
                [self._to] if unsent else [],
                [],
                max(0.0, left_s),
            )
            if left_s <= 0.0:
                raise RunFailed(f"the controller did not answer {when} within {within_s:g} s{self._last_words()}")
            if self._errors in readable:
                self._read_log()
            if writable:
                unsent = self._written(unsent, when)
            if self._from in readable:
                self._read_answer(when)
        answer, self._answer = self._answer, b""
        return answer.rstrip(b"\r\n")

    def close(self) -> None:
        """End the process; may be called again."""
        if self._is_closed:
            return
        self._is_closed = True
        for pipe in self._pipes:
            with contextlib.suppress(OSError):  # a process that has ended has not read everything
                pipe.close()
        try:
            self._child.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._child.kill()
            self._child.wait()

    def _check_silent(self, when: str) -> None:
        """Refuse text that nobody has asked for."""
        while select.select([self._from], [], [], 0.0)[0]:
            piece = os.read(self._from, _MAX_READ)
            if not piece:
                raise self._ended(when)
            self._answer += piece
            self._check_length(when)
        if self._answer:
            shown = one_line(self._answer[:80].decode(errors="replace"))
            raise RunFailed(f"the controller wrote {shown!r} before {when}: one line is the answer to one line")

    def _written(self, data: bytes, when: str) -> bytes:
        """Write as much as the pipe takes and return the rest."""
        try:
            return data[os.write(self._to, data) :]
        except BlockingIOError:
            return data
        except OSError:
            raise self._ended(when) from None

    def _read_answer(self, when: str) -> None:
        piece = os.read(self._from, _MAX_READ)
        if not piece:
            raise self._ended(when)
        self._answer += piece
        self._check_length(when)
        if b"\n" in self._answer[:-1]:
            raise RunFailed(f"the controller answered {when} with more than one line; one is the answer to one line")

    def _check_length(self, when: str) -> None:
        if len(self._answer) > MAX_LINE_BYTES:
            raise RunFailed(f"the controller answered {when} with more than {MAX_LINE_BYTES} bytes")

    def _read_log(self) -> None:
        piece = os.read(self._errors, _MAX_READ)
        self._log = (self._log + piece)[-_LOG_BYTES:]
        if not piece:
            self._errors = -1

    def _ended(self, when: str) -> RunFailed:
        """Return why the process has ended."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._child.wait(_END_S)
        while self._errors >= 0 and select.select([self._errors], [], [], 0.0)[0]:
            self._read_log()
        code = self._child.poll()
        how = "closed its output" if code is None else f"ended with status {code}"
        return RunFailed(f"the controller {how} before it answered {when}{self._last_words()}")

    def _last_words(self) -> str:
        """Return the last line on the standard error of the process, for the end of a message."""
        lines = self._log.decode(errors="replace").strip().splitlines()
        return one_line(f"; its last line of errors: {lines[-1]}") if lines else ""
