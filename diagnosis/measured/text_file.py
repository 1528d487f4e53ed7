"""The lines of a measured text file, and what was odd about them; numbers with the place of each that is none."""

import math
import re
from dataclasses import dataclass
from pathlib import Path

from symolo.core.errors import InputError

LARGEST_BYTES = 100_000_000
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_NO_NUMBER = re.compile(r"[-+]?(nan|inf(inity)?)|null|none|na|n/a|-|#n/a", re.IGNORECASE)


@dataclass(frozen=True)
class TextFile:
    path: Path
    lines: tuple[str, ...]
    """Without their ends."""
    is_whole: bool
    """Whether the last line has an end: one without may be cut off in the middle of a number."""
    notes: tuple[str, ...]
    """What was read all the same, in a sentence each."""


def read_text(path: Path) -> TextFile:
    """The lines of a UTF-8 file, with or without a byte-order mark, whose line ends are those of Unix or Windows.

    Raises:
        InputError: A folder, too large, out of reach, empty, no UTF-8 text, or with stray carriage returns.
    """
    data = _bytes_of(path)
    if data.startswith(_UTF_16):
        raise InputError("is UTF-16 text", where=str(path), cure="save it as UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        row = data.count(b"\n", 0, error.start) + 1
        raise InputError("is no UTF-8 text", where=f"{path}: row {row}", cure="save it as UTF-8") from None
    if not text.strip():
        raise InputError("is empty", where=str(path), cure="log again, or leave the file out")
    ends = text.count("\n"), text.count("\r\n")
    text = text.replace("\r\n", "\n")
    stray = text.find("\r")
    if stray >= 0:
        row = text.count("\n", 0, stray) + 1
        cure = "save it with one kind of line end, \\n"
        raise InputError("a carriage return within the row", where=f"{path}: row {row}", cure=cure)
    notes = [f"{path.name} begins with a byte-order mark"] if data.startswith(b"\xef\xbb\xbf") else []
    if 0 < ends[1] < ends[0]:
        notes.append(f"{path.name} mixes line ends: {ends[1]} of {ends[0]} rows end with \\r\\n; were two logs joined?")
    is_whole = text.endswith("\n")
    return TextFile(path, tuple(text.removesuffix("\n").split("\n")), is_whole, tuple(notes))


def _bytes_of(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise InputError("is a folder", where=str(path), cure="name the file")
        if path.exists() and not path.is_file():
            raise InputError("is no file", where=str(path), cure="name a file")
        if path.stat().st_size > LARGEST_BYTES:
            allowed = f"{LARGEST_BYTES / 1e6:.0f} MB"
            raise InputError("is too large", where=str(path), allowed=allowed, cure="split it into logs of their own")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None


def number(text: str, path: Path, row: int, column: str, allowed: str = "a number") -> float:
    """A finite number; `row` counts from 1, with the header.

    Raises:
        InputError: It is none; the text names file, row and column.
    """
    try:
        value = float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"column {column}", where=f"{path}: row {row}", got=text.strip(), allowed=allowed, cure=_cure(text.strip())
        )
    return value


def _cure(text: str) -> str:
    if _NO_NUMBER.fullmatch(text):
        return "leave the cell empty where nothing was measured"
    if re.fullmatch(r"[-+]?[0-9]+,[0-9]+", text):
        return "write decimals with a point"
    return ""
