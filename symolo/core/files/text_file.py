"""The lines of a text file, read strictly, and what was unusual about them."""

from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_named_file

MAX_BYTES = FileKind.LOG.max_bytes
UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""First bytes of a text in UTF-16."""
_CONTROLS = frozenset(range(32)) - frozenset(b"\t\n\r\f")
"""Bytes that no text has."""


@dataclass(frozen=True)
class LineFault:
    """What is wrong with one line of a text file."""

    line: int
    """Number of the line, from 1; 0 for the file as a whole."""
    message: str
    """Sentence without the place."""
    cure: str = ""
    """Advice to the user."""

    def error(self, path: Path) -> InputError:
        """Return the fault as an error that names file and row."""
        where = f"{path}: row {self.line}" if self.line else str(path)
        return InputError(self.message, where=where, cure=self.cure)


@dataclass(frozen=True)
class TextFile:
    """A text file without a fault."""

    path: Path
    lines: tuple[str, ...]
    """Lines without their ends."""
    is_whole: bool
    """Whether the last line has an end: one without may be cut off in the middle of a number."""
    notes: tuple[str, ...]
    """Unusual things that were read all the same, in one sentence each."""


def read_text(path: Path, *, of_any_encoding: bool = False) -> TextFile:
    """Read a UTF-8 file, with or without a byte-order mark, whose line ends are those of Unix or Windows.

    Args:
        path: The file.
        of_any_encoding: Whether UTF-16 and Windows-1252, in which spreadsheets write tables, are read with a note.

    Raises:
        InputError: It is a folder, too large, out of reach, empty, no UTF-8 text, or has stray carriage returns.
    """
    data, encoding = _bytes_of(path), ""
    if of_any_encoding:
        data, encoding = _as_utf_8(data)
    text = decode_text(data, path)
    if isinstance(text, LineFault):
        raise text.error(path)
    return replace(text, notes=(*text.notes, f"{path.name} is read as {encoding} text")) if encoding else text


def _as_utf_8(data: bytes) -> tuple[bytes, str]:
    """Return the bytes of a text in UTF-8, and its encoding if that is another one; other bytes as they are."""
    encoding = "UTF-16" if data.startswith(UTF_16_MARKS) else "Windows-1252"
    try:
        if encoding == "UTF-16":
            return data.decode(encoding).encode(), encoding
        data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if _CONTROLS.isdisjoint(data) and encoding != "UTF-16":
            with suppress(UnicodeDecodeError):
                return data.decode(encoding).encode(), encoding
    return data, ""


def decode_text(data: bytes, path: Path) -> TextFile | LineFault:
    """Return the lines of a file's content, or its first fault; `path` appears in notes only."""
    if data.startswith(UTF_16_MARKS):
        return LineFault(0, "is UTF-16 text", "save it as UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        return LineFault(data.count(b"\n", 0, error.start) + 1, "is no UTF-8 text", "save it as UTF-8")
    if not text.strip():
        return LineFault(0, "is empty", "log again, or leave the file out")
    ends = text.count("\n"), text.count("\r\n")
    text = text.replace("\r\n", "\n")
    stray = text.find("\r")
    if stray >= 0:
        row = text.count("\n", 0, stray) + 1
        return LineFault(row, "a carriage return within the row", "save it with one kind of line end, \\n")
    notes = [f"{path.name} begins with a byte-order mark"] if data.startswith(b"\xef\xbb\xbf") else []
    if 0 < ends[1] < ends[0]:
        notes.append(f"{path.name} mixes line ends: {ends[1]} of {ends[0]} rows end with \\r\\n; were two logs joined?")
    return TextFile(path, tuple(text.removesuffix("\n").split("\n")), text.endswith("\n"), tuple(notes))


def _bytes_of(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise InputError("is a folder", where=str(path), cure="name the file")
        if path.exists() and not path.is_file():
            raise InputError("is no file", where=str(path), cure="name a file")
        if path.stat().st_size > MAX_BYTES:
            allowed = f"{MAX_BYTES / 1e6:.0f} MB"
            raise InputError("is too large", where=str(path), allowed=allowed, cure="split it into several logs")
        return read_named_file(path, FileKind.LOG)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
