"""data.csv: a row per control period, in the columns of the paper's Table 5 or in those that were measured."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.files.text_file import LineFault, decode_text
from symolo.core.tables.table import MAX_FAULTS, NumberColumn, header_fault, table_of
from symolo.core.tables.time_series import Recording
from symolo.dataset.codes import State
from symolo.dataset.manifest import repair_cure
from symolo.dataset.tables.column import Column, Series

Ints = NDArray[np.int64]
Numbers = NDArray[np.float64 | np.int64]

STATES = tuple(state.value for state in State)
WHOLE = frozenset({"state", "img"})
"""Columns of whole numbers."""
_LARGEST = 2**53
"""Largest reading: up to it a float can represent every whole number, and no square overflows."""


RANGES = Series(
    "tof_m",
    "m",
    tuple(Column(f"d_{name[0]}", "m", 4, f"range of the {name} ToF sensor") for name in ("front", "left", "right")),
)
LINE = Series(
    "line",
    "1",
    tuple(Column(f"L{i}", "-", 5, f"reflectance of line sensor channel {i}, 0 black, 1 white") for i in range(8)),
)
ROW_TIME = Column("t", "ms", 0, "time since the first row")
COLUMNS = (
    ROW_TIME,
    Column("x", "m", 6, "position of the middle of the axle in the world frame W"),
    Column("y", "m", 6, "position of the middle of the axle in the world frame W"),
    Column("theta", "rad", 6, "heading from +x of W, counter-clockwise, from -3.141592 to 3.141593"),
    Column("state", "-", 0, "state of the controller, see below"),
    Column("v", "m/s", 6, "forward speed"),
    Column("w", "rad/s", 6, "yaw rate, counter-clockwise positive"),
    *RANGES.columns,
    *LINE.columns,
    Column("img", "-", 0, "number of the image taken at this row, 0 for none"),
)
HEADER = tuple(column.name for column in COLUMNS)
REQUIRED = ("t", "x", "y", "theta")
"""Columns that every data.csv has; the others may be absent from a trajectory that was imported."""
MAY_BE_EMPTY = frozenset(HEADER) - {*REQUIRED, *WHOLE}
"""Columns of readings. A cell of a trajectory that was imported is empty where nothing was measured."""
IMG_NEAREST = (
    "number of the image that is nearest in time to this row, 0 for none; "
    "time and pose of the image are in side/camera.csv and image_positions.txt"
)
"""Meaning of the column img if images are also taken between rows."""
NO_STATE = -1
"""State of the rows of a data.csv without the column `state`."""


@dataclass(frozen=True)
class Rows:
    """The content of one data.csv, rounded to the digits of the file, so that images made from both are the same.

    Readings that were not measured are NaN, in whole columns or in single rows.
    """

    t_ms: Ints
    """(N,), [ms], strictly increasing."""
    pose: Array
    """(N, 3), x [m], y [m], theta [rad] in W."""
    state: Ints
    """(N,), codes of the states."""
    twist: Array
    """(N, 2), v [m/s], w [rad/s]."""
    tof_m: Array
    """(N, 3), front, left, right [m]."""
    line: Array
    """(N, 8), reflectance."""
    image: Ints
    """(N,), image number, 0 for none."""
    columns: tuple[str, ...] = HEADER
    """Columns of the file, in the order of HEADER. In a column that is not among them, readings are NaN, states are
    NO_STATE, and images are 0."""

    def __post_init__(self) -> None:
        for array in (self.t_ms, self.pose, self.state, self.twist, self.tof_m, self.line, self.image):
            array.flags.writeable = False

    @classmethod
    def from_recording(cls, recording: Recording) -> "Rows":
        trajectory = recording.trajectory
        pose = trajectory.pose.copy()
        pose[:, 2] = heading(pose[:, 2], COLUMNS[HEADER.index("theta")].decimals)
        sensors = [recording[name].values for name in (RANGES.name, LINE.name, "image")]
        columns = (np.rint(trajectory.t_s * 1000), pose, trajectory.state, trajectory.twist, *sensors)
        table = np.column_stack(columns).astype(np.float64)
        return cls.from_table(rounded(table, COLUMNS))

    @classmethod
    def from_table(cls, table: Array, columns: Sequence[str] = HEADER) -> "Rows":
        """Return the rows with these columns of data.csv, (N, columns), in the order of HEADER."""
        whole = np.full((len(table), len(HEADER)), np.nan)
        whole[:, HEADER.index("state")], whole[:, HEADER.index("img")] = NO_STATE, 0
        whole[:, [HEADER.index(name) for name in columns]] = table
        return cls(
            t_ms=np.rint(whole[:, 0]).astype(np.int64),
            pose=whole[:, 1:4].copy(),
            state=whole[:, 4].astype(np.int64),
            twist=whole[:, 5:7].copy(),
            tof_m=whole[:, 7:10].copy(),
            line=whole[:, 10:18].copy(),
            image=whole[:, 18].astype(np.int64),
            columns=tuple(columns),
        )

    @property
    def definitions(self) -> tuple[Column, ...]:
        """Definitions of `columns`."""
        return tuple(COLUMNS[HEADER.index(name)] for name in self.columns)

    @property
    def has_state(self) -> bool:
        """Whether the states of the controller are known."""
        return "state" in self.columns

    def table(self) -> Array:
        """Return the columns of data.csv, (N, columns)."""
        series = (self.t_ms, self.pose, self.state, self.twist, self.tof_m, self.line, self.image)
        whole = np.column_stack([one.astype(np.float64) for one in series])
        return whole if self.columns == HEADER else whole[:, [HEADER.index(name) for name in self.columns]]

    def where(self, is_wanted: NDArray[np.bool_]) -> "Rows":
        """Return the rows for which a mask (N,) is True."""
        return Rows(
            t_ms=self.t_ms[is_wanted],
            pose=self.pose[is_wanted],
            state=self.state[is_wanted],
            twist=self.twist[is_wanted],
            tof_m=self.tof_m[is_wanted],
            line=self.line[is_wanted],
            image=self.image[is_wanted],
            columns=self.columns,
        )

    def at(self, row: int) -> Array:
        """Return one row of `table`, (columns,)."""
        one = (self.pose, self.twist, self.tof_m, self.line)
        pose, twist, tof_m, line = (series[row] for series in one)
        whole = np.array([self.t_ms[row], *pose, self.state[row], *twist, *tof_m, *line, self.image[row]], np.float64)
        return whole if self.columns == HEADER else whole[[HEADER.index(name) for name in self.columns]]

    def to_csv(self) -> bytes:
        return csv_bytes(self.columns, [column.decimals for column in self.definitions], self.table())


def rounded(table: Array, columns: Sequence[Column]) -> Array:
    """Return numbers (N, columns) with the digits of their columns and without negative zeros."""
    values = [
        [round(value, column.decimals) + 0.0 for value in table[:, i].tolist()] for i, column in enumerate(columns)
    ]
    return np.array(values, np.float64).reshape(len(columns), len(table)).T


def wrapped(yaw_rad: Array) -> Array:
    """Return the same directions in (-pi, pi]."""
    return -((-yaw_rad + math.pi) % (2 * math.pi) - math.pi)


def heading(yaw_rad: Array, decimals: int) -> Array:
    """Return the same directions, rounded; half a turn is positive, even if it results from rounding."""
    half_turn = round(math.pi, decimals)
    rounded = np.array([round(yaw, decimals) for yaw in wrapped(yaw_rad).tolist()])
    return np.where(rounded <= -half_turn, half_turn, rounded)


def csv_bytes(header: Sequence[str], decimals: Sequence[int], table: Numbers, separator: str = ",") -> bytes:
    """Return a table as text with fixed decimals and without negative zeros; the same numbers give the same bytes.

    Cells of NaN are empty.
    """
    lines = [separator.join(header)]
    lines += [
        separator.join(
            f"{round(value, digits) + 0.0:.{digits}f}" if value == value else ""  # noqa: PLR0124 - NaN is not
            for value, digits in zip(row, decimals, strict=True)
        )
        for row in table.tolist()
    ]
    return ("\n".join(lines) + "\n").encode()


@dataclass(frozen=True)
class Fault:
    """A fault of a table, with the line of the file."""

    line: int
    what: str
    cure: str = "repair or remove the row"
    """Advice to the user."""
    kind: Literal["form", "time", "state", "image"] = "form"

    def __str__(self) -> str:
        return f"line {self.line}: {self.what}"


def read_rows(path: Path) -> Rows:
    """Read a data.csv strictly.

    Raises:
        InputError: The first fault, with its line and column.
    """
    try:
        data = read_file(path, FileKind.TABLE)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
    table, columns, faults = parse_rows(data)
    faults = faults or _faults_of_order(Rows.from_table(table, columns))
    if faults:
        fault = _in_seconds(table[:, 0]) if faults[0].kind == "time" else None
        fault = fault or faults[0]
        raise InputError(fault.what, where=f"{path}:{fault.line}", cure=repair_cure(path, fault.cure))
    return Rows.from_table(table, columns)


def _faults_of_order(rows: Rows) -> list[Fault]:
    return [fault for fault in semantic_faults(rows) if fault.kind in ("time", "image")]


def parse_rows(data: bytes) -> tuple[Array, tuple[str, ...], list[Fault]]:
    """Return the numbers (N, columns) of a data.csv, the names of its columns, and every fault of its format.

    It has the columns of REQUIRED and any of the others, in the order of HEADER.
    """
    optional = [name for name in HEADER if name not in REQUIRED]
    return _parsed(data, HEADER, ",", optional, MAY_BE_EMPTY)


def _in_seconds(t_ms: Array) -> Fault | None:
    """Return the fault of times that increase, but are the same when they are rounded to milliseconds."""
    if np.any(np.diff(t_ms) <= 0.0):
        return None
    row = int(np.flatnonzero(np.diff(np.rint(t_ms)) <= 0.0)[0]) + 1
    what = f"column t: {t_ms[row]:g} ms is not a millisecond after {t_ms[row - 1]:g} ms"
    return Fault(row + 2, what, "give t in milliseconds; this looks like seconds: multiply it by 1000", "time")


def parse_table(
    data: bytes, header: Sequence[str], separator: str = ",", may_be_empty: Collection[str] = ()
) -> tuple[Array, list[Fault]]:
    """Return the numbers (N, columns) of a table with exactly this header, and every fault of its format.

    Empty cells of the columns that `may_be_empty` read as NaN.
    """
    table, _, faults = _parsed(data, header, separator, may_be_empty=may_be_empty)
    return table, faults


def _parsed(
    data: bytes,
    names: Sequence[str],
    separator: str,
    optional: Collection[str] = (),
    may_be_empty: Collection[str] = (),
) -> tuple[Array, tuple[str, ...], list[Fault]]:
    """Return numbers, columns and faults of a table with these columns in this order, of which some are `optional`."""

    def broken(faults: Sequence[LineFault]) -> tuple[Array, tuple[str, ...], list[Fault]]:
        listed = [Fault(max(fault.line, 1), fault.message, fault.cure) for fault in faults]
        return np.empty((0, len(names))), tuple(names), listed

    text = decode_text(data, Path())
    if isinstance(text, LineFault):
        return broken([text])
    header = text.lines[0].split(separator)
    if fault := header_fault(header, names, separator, optional, is_ordered=True):
        return broken([fault])
    columns = [
        NumberColumn(name, may_be_empty=name in may_be_empty, is_whole=name in WHOLE, low=-_LARGEST, high=_LARGEST)
        for name in header
    ]
    table = table_of(text, columns, range(len(header)), first=1, separator=separator)
    if table.faults:
        return broken(table.faults)
    return np.column_stack([table.numbers[name] for name in header]), tuple(header), []


def semantic_faults(rows: Rows) -> list[Fault]:
    """Return the rows whose time does not increase, whose state is unknown, or whose image number does not increase.

    At most `MAX_FAULTS` of each kind are listed.
    """
    faults = [
        Fault(int(i) + 3, f"column t: {rows.t_ms[i + 1]} ms is not after {rows.t_ms[i]} ms", kind="time")
        for i in np.flatnonzero(np.diff(rows.t_ms) <= 0)[:MAX_FAULTS]
    ]
    faults += [
        Fault(int(i) + 2, f"column state: {rows.state[i]} is none of {', '.join(map(str, STATES))}", kind="state")
        for i in np.flatnonzero(rows.has_state & ~np.isin(rows.state, STATES))[:MAX_FAULTS]
    ]
    at = np.flatnonzero(rows.image)
    numbers = rows.image[at]
    previous = np.concatenate(([0], numbers[:-1]))
    faults += [
        Fault(int(at[i]) + 2, f"column img: {numbers[i]} does not count up from {previous[i]}", kind="image")
        for i in np.flatnonzero(numbers <= previous)[:MAX_FAULTS]
    ]
    return sorted(faults, key=lambda fault: fault.line)
