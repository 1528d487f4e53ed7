"""Looks at the beginning of files, by which their kind is recognised; nothing here raises an error."""

from collections.abc import Callable, Sequence
from math import isfinite
from pathlib import Path

from symolo.core.files.plain_files import open_named_file
from symolo.core.files.text_file import UTF_16_MARKS
from symolo.core.tables.table import number_of

MAX_COMMENTS = 100
"""Lines of comments above a header that are skipped."""
MAX_TITLES = 10
"""Most lines of a title above a header."""


def is_file(path: Path) -> bool:
    """Return whether there is such a file; false, without a PermissionError, in a folder without permission."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_folder(path: Path) -> bool:
    """Return whether there is such a folder; false, without a PermissionError, in a folder without permission."""
    try:
        return path.is_dir()
    except OSError:
        return False


def only_log(path: Path, is_log: Callable[[Path], bool]) -> Path | None:
    """Return the file itself, or the only log in a folder; None if there is none or more than one."""
    if not is_folder(path):
        return path if is_log(path) else None
    logs = [file for file in path.glob("*.csv") if is_log(file)]
    return logs[0] if len(logs) == 1 else None


def first_bytes(path: Path, count: int) -> bytes:
    """Return the first bytes of a file; none for a folder and for a file that cannot be read."""
    if not is_file(path):  # opening a pipe or a device could wait forever
        return b""
    try:
        with open_named_file(path) as file:
            return file.read(count)
    except (OSError, ValueError):
        return b""


def first_line(path: Path) -> str:
    """Return the first line of a file without spaces; empty for a folder and for a file that cannot be read."""
    return "".join(first_row(path).split())


def first_row(path: Path, *, skips_comments: bool = False) -> str:
    """Return the first line of a file as it is, with its tabs; empty for a folder and a file that cannot be read.

    Args:
        path: The file.
        skips_comments: Whether to return the first line, of the first hundred, that neither is empty nor begins with #.
    """
    for row in _rows(path, MAX_COMMENTS if skips_comments else 1):
        if not skips_comments or (row.strip() and not row.startswith("#")):
            return row
    return ""


def has_separator_below_title(path: Path, separators: Sequence[str]) -> bool:
    """Return whether one of the first rows, of which those above it may be a title, has one of the separators."""
    rows = [row.strip() for row in _rows(path, MAX_COMMENTS) if row.strip() and not row.startswith("#")]
    is_text = not any("\0" in row for row in rows)
    return is_text and any(separator in row for row in rows[: MAX_TITLES + 1] for separator in separators)


def names_above_numbers(path: Path) -> list[str]:
    """Return the words of the header above the first row of numbers, separated by spaces; none if it has no header."""
    rows = [row.lstrip("# ").split() for row in _rows(path, MAX_COMMENTS) if row.strip("# \n\r")]
    numbers = [bool(row) and all(isfinite(number_of(cell)) for cell in row) for row in rows]
    first = numbers.index(True) if True in numbers else 0
    return rows[first - 1] if first > 0 and len(rows[first - 1]) == len(rows[first]) > 2 else []


def _rows(path: Path, count: int) -> list[str]:
    """Return the first rows of a file; none for a folder and a file that cannot be read."""
    if not is_file(path):  # opening a pipe or a device could wait forever
        return []
    try:
        with open_named_file(path) as file:
            if file.read(2) in UTF_16_MARKS:
                file.seek(0)
                text = file.read(4096 * (MAX_TITLES + 1)).decode("utf-16", errors="replace")
                return text.splitlines(keepends=True)[:count]
            file.seek(0)
            rows = (file.readline(4096) for _ in range(count))
            return [row.decode("utf-8-sig", errors="replace") for row in rows if row]
    except (OSError, ValueError):
        return []
