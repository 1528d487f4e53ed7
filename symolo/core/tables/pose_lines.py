"""Files with a pose in each line, without a header, such as those of the TUM and KITTI benchmarks."""

from pathlib import Path

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import open_named_file
from symolo.core.files.text_file import read_text
from symolo.core.tables.table import NO_NUMBER, number

_PEEKED_BYTES = 4096


def numbers_in_first_line(path: Path) -> int:
    """Return how many numbers the first line has that is no comment; 0 if it has anything else. It never raises."""
    try:
        if not path.is_file():
            return 0
        with open_named_file(path) as file:
            text = file.read(_PEEKED_BYTES).decode("utf-8-sig", errors="replace")
    except (OSError, ValueError):
        return 0
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    try:
        return len([float(cell) for cell in lines[0].split()]) if lines else 0
    except ValueError:
        return 0


def read_pose_lines(path: Path, names: tuple[str, ...]) -> tuple[Array, list[int]]:
    """Return the numbers (N, names) of the lines that are no comments, and the number of each line, from 1.

    Raises:
        InputError: A line has other cells than numbers with these names, or there is none.
    """
    text = read_text(path)
    rows, lines = [], []
    for row, line in enumerate(text.lines, 1):
        if not line.strip() or line.startswith("#"):
            continue
        cells = line.split()
        where = f"{path}: row {row}"
        if len(cells) != len(names):
            cure = "the file is cut off: remove the row" if row == len(text.lines) else "repair or remove the row"
            raise InputError(f"{len(cells)} numbers", where=where, allowed=" ".join(names), cure=cure)
        if any(NO_NUMBER.fullmatch(cell) for cell in cells):
            raise InputError("a number that is missing", where=where, got=line.strip(), cure="remove the row")
        rows.append([number(cell, name, where) for cell, name in zip(cells, names, strict=True)])
        lines.append(row)
    if not rows:
        raise InputError("has no poses", where=str(path), allowed=" ".join(names))
    return np.array(rows), lines


def check_times(t_s: Array, lines: list[int], path: Path) -> None:
    """Refuse times that do not increase.

    Raises:
        InputError: One does not; its line is named.
    """
    wrong = np.flatnonzero(np.diff(t_s) <= 0.0)
    if len(wrong):
        i = int(wrong[0]) + 1
        what = f"the time {t_s[i]:.9g} s is not after {t_s[i - 1]:.9g} s"
        raise InputError(what, where=f"{path}: row {lines[i]}", cure="sort the poses by time, each time once")
