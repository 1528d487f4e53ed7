"""data.csv of SyMoLo, from symolo or elsewhere: its columns, in its units."""

from pathlib import Path

from logs.recognition import first_line
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from symolo.dataset.tables.rows import HEADER, MAY_BE_EMPTY, REQUIRED, WHOLE, read_rows

_ONLY_SYMOLO = WHOLE
"""Columns that only SyMoLo has; without them, the units of t, x, y and theta are not certain."""


def _recognises(path: Path) -> bool:
    names = first_line(path).split(",")
    return {*REQUIRED} <= set(names) <= {*HEADER} and bool(_ONLY_SYMOLO & set(names))


def _read(path: Path, _settings: ReadSettings) -> list[LoggedTrajectory]:
    rows = read_rows(path.resolve())  # the user has named it, and it may be a link
    table = dict(zip(rows.columns, rows.table().T, strict=True))
    quantities = {column.name: f"{column.name}, in {column.unit}" for column in rows.definitions}
    readings = {name: table[name].copy() for name in rows.columns if name in MAY_BE_EMPTY | {"state", "img"}}
    return [LoggedTrajectory(rows.t_ms / 1000, rows.pose.copy(), quantities, readings)]


READER = TrajectoryReader("symolo", "data.csv in the columns of SyMoLo", _recognises, _read)
