"""Child processes that do work for their owner: JSON requests on standard input, JSON messages back, one a line.

The workers of a release and the Blender process speak this protocol. A child sends `Alive` every few seconds, whatever
it is doing, and ends each request by `Finished` or `Failed`. Its owner keeps the child's standard input open for as
long as it needs the child: when the owner dies, even by SIGKILL, the operating system closes it, and the child removes
its scratch folder and ends itself with all that it started.
"""

import contextlib
import math
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Generic, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

SCRATCH = "SYMOLO_SCRATCH"
"""Environment variable of a child that names the folder of its temporary files."""
SILENCE_S = 120.0
"""Time without any message after which a child counts as stuck."""
GB = 1e9
_SECONDS_BETWEEN_BEATS = 5.0
_SECONDS_BETWEEN_CHECKS = 0.2
_LOG_BYTES = 20_000
_MEMORY_SIGNALS = frozenset({signal.SIGKILL, signal.SIGABRT, signal.SIGSEGV})
"""Signals that end a process which gets no more memory; the last two have other causes too."""


class Message(BaseModel):
    """One line of JSON between an owner and its child."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Alive(Message):
    """Sent every few seconds by a child that works."""

    kind: Literal["alive"] = "alive"


class Finished(Message):
    """The request is done."""

    kind: Literal["finished"] = "finished"


ErrorKind = Literal["input", "environment", "run", "bug", "killed", "engine"]


class Failed(Message):
    """The request failed.

    `environment`: the machine lacks something, and the text names the remedy. `killed`: the child died or was ended.
    """

    kind: Literal["failed"] = "failed"
    error: ErrorKind
    text: str


M = TypeVar("M")


class ChildProcess(Generic[M]):
    """A child process as its owner sees it; it starts at once, and `close` ends it."""

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        messages: TypeAdapter[M],
        environment: Mapping[str, str],
        *,
        own_group: bool = False,
    ) -> None:
        """Start the child.

        Args:
            name: Name of the child in messages, such as "the worker".
            command: Program and arguments.
            messages: Union of all messages that the child sends.
            environment: All environment variables of the child.
            own_group: Whether it leads a process group, which is killed with it.
        """
        self._name = name
        self._messages = messages
        self._own_group = own_group
        self._log = tempfile.TemporaryFile("a+b")  # noqa: SIM115 - lives as long as the process
        self._lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._over = False
        self._child = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            env=dict(environment),
            start_new_session=own_group,
        )
        try:
            threading.Thread(target=self._read_lines, name="read a child's messages", daemon=True).start()
        except BaseException:  # no thread could start: the caller gets no object that it could close
            self.close()
            raise

    @property
    def alive(self) -> bool:
        return not self._over

    def ask(
        self,
        request: Message,
        *,
        patience_s: float = math.inf,
        start_s: float = 0.0,
        silence_s: float = SILENCE_S,
        memory_bytes: int = 0,
    ) -> Iterator[M | Failed]:
        """Send a request and yield the child's messages except `Alive`; the last one is `Finished` or `Failed`.

        A child that dies or is ended here leads to a `Failed` of kind `killed`.

        Args:
            request: Request that the child executes.
            patience_s: Time without a message other than `Alive` after which the child is ended.
            start_s: Time for the first such message, where it is longer than `patience_s`.
            silence_s: Time without any message after which the child is ended.
            memory_bytes: Resident memory of the child and its children beyond which it is ended; 0 for no limit.
        """
        self._log.truncate(0)
        heard_s = moved_s = time.monotonic()
        limit_s = max(patience_s, start_s)
        with contextlib.suppress(BrokenPipeError):  # a child that is dead already is noticed below
            assert self._child.stdin is not None  # noqa: S101 - it is a pipe
            self._child.stdin.write(request.model_dump_json().encode() + b"\n")
            self._child.stdin.flush()
        while True:
            line = self._next_line()
            if line == b"":
                self.end()
                yield Failed(error="killed", text=f"{self._name} was ended by {self._exit_status()}")
                return
            if line is not None and (message := self._parsed(line)) is not None:
                if not isinstance(message, Alive):
                    yield message
                    if isinstance(message, Finished | Failed):
                        return
                    moved_s, limit_s = time.monotonic(), patience_s
                heard_s = time.monotonic()
            now, reason = time.monotonic(), ""
            if now - heard_s > silence_s:
                reason = f"it did not respond for {silence_s:g} s"
            elif now - moved_s > limit_s:
                reason = f"it made no progress in {limit_s:g} s"
            elif memory_bytes and (used := memory_of(self._child.pid)) > memory_bytes:
                reason = f"it used {used / GB:.2f} GB of memory, and {memory_bytes / GB:.2f} GB are allowed"
            if reason:
                self.end()
                yield Failed(error="killed", text=f"{self._name} was ended, because {reason}")
                return

    def last_lines(self, count: int) -> list[str]:
        """Return the last lines that the child printed on standard error since the last request."""
        self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, self._log.tell() - _LOG_BYTES))
        # Behind a cut the file begins with zeros up to where the child writes on.
        return self._log.read().replace(b"\0", b"").decode(errors="replace").strip().splitlines()[-count:]

    def kill(self) -> None:
        """Kill the child, and its process group if it leads one; any thread may call this at any time."""
        with self._lock:
            # Until the child is waited for, its process number cannot belong to another process.
            if not self._over:
                with contextlib.suppress(ProcessLookupError):
                    if self._own_group:
                        os.killpg(self._child.pid, signal.SIGKILL)
                    else:
                        self._child.kill()

    def end(self) -> None:
        """Kill the child and wait for its end."""
        self.kill()
        with self._lock:
            self._over = True
        with contextlib.suppress(BrokenPipeError), self._child:  # the child may not have read all of its input
            pass

    def close(self) -> None:
        """End the child and delete its log."""
        self.end()
        self._log.close()

    def _read_lines(self) -> None:
        """Put the child's lines into the queue, and an empty one at their end."""
        assert self._child.stdout is not None  # noqa: S101 - it is a pipe
        with contextlib.suppress(ValueError):  # `end` closes the pipe
            for line in self._child.stdout:
                self._lines.put(line)
        self._lines.put(b"")

    def _next_line(self) -> bytes | None:
        """Wait a moment for a line; None where there is none yet, empty after the last one."""
        try:
            return self._lines.get(timeout=_SECONDS_BETWEEN_CHECKS)
        except queue.Empty:
            return None

    def _parsed(self, line: bytes) -> M | None:
        try:
            return self._messages.validate_json(line)
        except ValidationError:  # the last line of a child that was killed while it wrote is cut short
            return None

    def _exit_status(self) -> str:
        code = self._child.returncode
        if code >= 0:
            return f"exit code {code}"
        cure = " (too little memory? Take fewer --workers or smaller images)" if -code in _MEMORY_SIGNALS else ""
        return f"signal {signal.Signals(-code).name}{cure}"


def memory_of(process: int) -> int:
    """Return the resident memory [bytes] of a process and all its children; what they share counts for each of them."""
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


class Owner:
    """The process that started this one, as the child sees it; made once, before the child's work begins."""

    def __init__(self) -> None:
        # Engines print to file descriptor 1 whatever sys.stdout is: the messages get a descriptor of their own.
        self._stream = os.fdopen(os.dup(1), "w", encoding="utf-8")
        os.dup2(2, 1)
        self._lock = threading.Lock()
        self._requests: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=self._listen, daemon=True).start()
        threading.Thread(target=self._send_beats, daemon=True).start()

    def next_request(self) -> str:
        """Wait for the next request and return its JSON text."""
        return self._requests.get()

    def send(self, message: Message) -> None:
        """Send a message; any thread may call this."""
        with self._lock:
            self._stream.write(message.model_dump_json() + "\n")
            self._stream.flush()

    def _send_beats(self) -> None:
        # Engines let other threads run while they work; a process that is stopped or stuck falls silent.
        while True:
            time.sleep(_SECONDS_BETWEEN_BEATS)
            self.send(Alive())

    def _listen(self) -> None:
        for line in sys.stdin:
            self._requests.put(line)
        if scratch := os.environ.get(SCRATCH):
            shutil.rmtree(scratch, ignore_errors=True)
        if os.getpgrp() == os.getpid():
            os.killpg(0, signal.SIGKILL)
        os._exit(1)
