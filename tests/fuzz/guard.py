"""One input given to one reader: what must not happen, and how it is named.

The child that decodes images for a reader is held to the same limits.
"""

import os
import resource
import signal
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from symolo.core.errors import FaultsError
from symolo.core.files.image_decoder import decode_images

SECONDS = 2.0
"""Of the processor, within which an input is read or refused."""
BYTES = 500_000_000
"""Memory that a reader may need for an input, beside what the process has before it."""
MAX_CHARS = 2000
"""Longest message of a fault."""
MAX_LINES = 25
"""Longest message of several faults."""
_ROOT = Path(__file__).parents[2]

Read = Callable[[bytes], None]
"""Reads an input; raises what a user would see as one line."""


class TooSlowError(BaseException):
    """Not an Exception, so that no reader takes it for a fault of its file."""


@dataclass(frozen=True)
class Outcome:
    """What came of one input."""

    problem: str = ""
    """What went wrong, the same for the same fault of the code; empty where nothing did."""
    refusal: str = ""
    """Message with which the input was refused; empty where it was read."""


def outcome_of(read: Read, data: bytes, refusals: tuple[type[Exception], ...]) -> Outcome:
    """Return what comes of an input, within `limits`.

    Args:
        read: The reader.
        data: The input.
        refusals: Errors that the reader may raise; their message must be one line for each of few faults.
    """
    # A fuzzer that has run for long holds much memory of its own, which is none of the reader.
    _limit_memory()
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    begin = _children_s()
    try:
        read(data)
        if _children_s() - begin > SECONDS:
            return Outcome(f"more than {SECONDS:g} s in a child")
    except refusals as error:
        text = str(error)
        listed = error.faults if isinstance(error, FaultsError) else (error,)
        lines = max(len(str(fault).splitlines()) for fault in listed)
        if lines > 1 or max(len(str(fault)) for fault in listed) > MAX_CHARS or len(text.splitlines()) > MAX_LINES:
            return Outcome(f"{type(error).__name__}: more than a line {_place_of(error)}")
        return Outcome(refusal=text)
    except TooSlowError as error:
        return Outcome(f"more than {SECONDS:g} s {_place_of(error)}")
    except MemoryError as error:
        return Outcome(f"more than {BYTES // 1_000_000} MB {_place_of(error)}")
    except Exception as error:  # noqa: BLE001 - whatever it is, a user would see a traceback
        return Outcome(f"{type(error).__name__} {_place_of(error)}")
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return Outcome()


def _place_of(error: BaseException) -> str:
    """Return the last line of our own code that the traceback passes."""
    ours = [frame for frame in traceback.extract_tb(error.__traceback__) if _is_ours(frame.filename)]
    if not ours:
        return "outside of the project"
    return f"at {Path(ours[-1].filename).relative_to(_ROOT)}:{ours[-1].lineno} in {ours[-1].name}"


def _is_ours(file: str) -> bool:
    path = Path(file)
    return path.is_relative_to(_ROOT) and ".venv" not in path.parts and "fuzz" not in path.parts


@contextmanager
def limits() -> Iterator[None]:
    """Raise `TooSlowError` in the reader when its time is over, and MemoryError beyond `BYTES`; undone at the end."""

    def too_slow(_number: int, _frame: FrameType | None) -> None:
        raise TooSlowError

    before = signal.signal(signal.SIGPROF, too_slow)
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    decode_images([])  # starts the child, which is limited by itself
    for child in _children():
        resource.prlimit(child, resource.RLIMIT_DATA, (_data_bytes(child) + BYTES, hard))
    _limit_memory()
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
        signal.signal(signal.SIGPROF, before)


def _limit_memory() -> None:
    """Let this process take `BYTES` more than it has now."""
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (_data_bytes() + BYTES, hard))


def _data_bytes(process: int | str = "self") -> int:
    """Return the memory that a process may write to, which address space that the allocator reserves is not."""
    pages = int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[5])
    return pages * resource.getpagesize()


def _children() -> list[int]:
    children: list[int] = []
    for thread in Path("/proc/self/task").iterdir():
        with suppress(OSError):  # a thread of the reader has just ended
            children += map(int, (thread / "children").read_text(encoding="ascii").split())
    return children


def _children_s() -> float:
    """Return the time of the processor of all children, ended ones too."""
    ended, ticks = resource.getrusage(resource.RUSAGE_CHILDREN), 0
    for child in _children():
        with suppress(OSError):  # it has just ended
            stat = Path(f"/proc/{child}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
            ticks += int(stat[11]) + int(stat[12])
    return ended.ru_utime + ended.ru_stime + ticks / os.sysconf("SC_CLK_TCK")
