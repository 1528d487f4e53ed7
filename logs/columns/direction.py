"""Columns that state the sense in which a motor turns, beside a duty cycle or a voltage without a sign."""

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from logs.columns.drive import VOLTAGE
from logs.columns.quantity import LEFT, RIGHT, SIDES, LogKind, words
from logs.counts import running_counts
from logs.log_file import LogFile
from logs.mapping import VOLTAGES, Source
from logs.units.names import taken_apart
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.tables.table import number_of

DIRECTION = words("dir dirs direction directions sign sense richtung drehrichtung")
"""Words of a column with the sense of a motor."""
FORWARD = words("forward forwards fwd fw f ahead +")
BACKWARD = words("backward backwards bwd bw b back reverse reversed rev r neg negative -")
MOST = 0.5
"""Sum of the turns of a wheel, as a share of the sum of their sizes, from which on it turns in one sense."""
MIN_ROWS = 3
"""Rows in which a wheel turns that show the sense of a value."""
_SIDE = {"u_left_V": LEFT, "u_right_V": RIGHT, "u_cmd_V": frozenset[str]()}
_MOTION = {"u_left_V": "enc_left_ticks", "u_right_V": "enc_right_ticks", "u_cmd_V": "omega_rad_s"}
"""Quantity that shows the sense of a motor with this voltage."""


def mark_directions(log: LogFile, sources: dict[str, Source], warnings: list[str], kind: LogKind) -> None:
    """Add to each voltage without a sign the column of its sense, with a sentence for each.

    Args:
        log: The log.
        sources: Sources of the quantities, in which those of voltages are replaced.
        warnings: List to which the sentences are added.
        kind: Kind of the log.

    Raises:
        InputError: The values of such a column do not show which of them means backwards.
    """
    for name in VOLTAGES:
        source = sources.get(name)
        column = _direction_column(log, name, sources, kind.fillers) if source and source.column else ""
        if source is None or not column or not _is_without_sign(log, source.column):
            continue
        backwards, moved, duty = _by_words(log, column), _moved(log, name, sources), log.numbers(source.column)
        if backwards is not None and moved is not None and _is_size(log.signs(column, backwards) < 0.0, duty, moved):
            text = f"without a sign, as is {sources[_MOTION[name]].column}"
            warnings.append(f"{source.column} ({name}): {text}; {column}, which would give it one, is not used")
            continue
        if backwards is None:
            if moved is None:
                continue
            backwards = _by_motion(log, column, duty, moved, option=kind.mapping_option)
        source = source.model_copy(update={"direction": column, "backwards": backwards})
        text = f"it is taken for negative where {column} is {source.backwards_text}"
        text = text if backwards else f"it is never negative by {column}"
        warnings.append(f"{source.column} ({name}): without a sign; {text}")
        sources[name] = source


def _direction_column(log: LogFile, name: str, sources: Mapping[str, Source], fillers: Collection[str]) -> str:
    """Return the column of the sense of the motor with this voltage; empty if there is none."""
    used = {column for source in sources.values() for column in source.columns}
    allowed = DIRECTION | VOLTAGE | _SIDE[name] | words("m drive") | {*fillers}
    for column in log.columns:
        names = {*taken_apart(column).words}
        has_side = bool(names & _SIDE[name]) if _SIDE[name] else not names & SIDES
        if column not in used and names & DIRECTION and has_side and not names - allowed:
            return column
    return ""


def _is_without_sign(log: LogFile, column: str) -> bool:
    """Return whether all values of a column are positive or zero, as far as they can be read."""
    try:
        numbers = log.numbers(column)
    except InputError:  # wrong cells are reported together, when the rows are read
        return False
    return not np.any(numbers < 0.0)


def _by_words(log: LogFile, column: str) -> tuple[str | float, ...] | None:
    """Return the values of a column that mean backwards, by their words or signs; None if neither shows it."""
    values = [value for value in dict.fromkeys(log.columns[column]) if value]
    lower = {value.lower() for value in values}
    if lower & BACKWARD and (lower & FORWARD or lower <= BACKWARD):
        return tuple(value for value in values if value.lower() in BACKWARD)
    if lower and lower <= FORWARD:
        return ()
    numbers = [number_of(value) for value in values]
    negative = tuple(number for number in numbers if number < 0.0)
    return negative if negative and np.isfinite(numbers).all() else None


def _moved(log: LogFile, name: str, sources: Mapping[str, Source]) -> Array | None:
    """Return by how far (N,) the motor turns while its voltage of each row acts; None if the log does not have it."""
    motion = _MOTION[name]
    if motion not in sources or not sources[motion].column:
        return None
    try:
        numbers = sources[motion].factor * sources[motion].numbers(log)
    except InputError:  # wrong cells are reported together, when the rows are read
        return None
    if motion == "omega_rad_s":
        return numbers
    return np.diff(running_counts(numbers, sources[motion], motion, []), append=np.nan)


def _share(rows: NDArray[np.bool_], duty: Array, moved: Array) -> float:
    """Return the sum of the turns of a driven motor in rows (N,) as a share of their sizes; NaN of too few rows."""
    turns = moved[rows & (duty > 0.0) & np.isfinite(moved) & (moved != 0.0)]
    return float(turns.sum() / np.abs(turns).sum()) if len(turns) >= MIN_ROWS else np.nan


def _is_size(is_backwards: NDArray[np.bool_], duty: Array, moved: Array) -> bool:
    """Return whether the motion is a size without a sign: in one sense in rows backwards (N,) and in the others."""
    shares = _share(is_backwards, duty, moved), _share(~is_backwards, duty, moved)
    return min(map(abs, shares)) >= MOST and shares[0] * shares[1] > 0.0


def _by_motion(log: LogFile, column: str, duty: Array, moved: Array, *, option: str) -> tuple[str | float, ...]:
    """Return the values of a column with which a motor turns backwards.

    Raises:
        InputError: With one of the values, the motor turns in both senses.
    """
    cells = np.array(log.columns[column])
    backwards: list[str | float] = []
    for value in (value for value in dict.fromkeys(log.columns[column]) if value):
        share = _share(cells == value, duty, moved)
        if abs(share) < MOST:
            raise InputError(
                f"column {column}: neither the values nor the turns of the motor show which one means backwards",
                where=log.header_where,
                got=[*dict.fromkeys(log.columns[column])],
                cure=f"in a file for {option}, add direction: {column} and backwards: [VALUE] to the voltage, or"
                " rename the column if it is something else",
            )
        if share < 0.0:
            number = number_of(value)
            backwards.append(number if np.isfinite(number) else value)
    return tuple(backwards)
