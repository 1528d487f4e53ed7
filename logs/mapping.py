"""The mapping file of a log: which of its columns, in which unit, is which quantity."""

import json
import shlex
from collections.abc import Collection, Mapping, Sequence
from math import pi, radians
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, ValidationError

from configs.schema.base import FromList, Section
from configs.validation.schema_faults import all_explained
from configs.validation.shapes import Shape
from logs.columns.drive import COUNTED
from logs.columns.quantity import LogKind
from logs.columns.quaternion_heading import heading_of
from logs.log_file import LogFile
from logs.units.names import PERCENT, factor_to, unit_of
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError, nearest
from symolo.core.yaml.reader import read_yaml

MAPPING = "mapping.yaml"
VOLTAGES = ("u_left_V", "u_right_V", "u_cmd_V")
"""Quantities that a duty cycle and the voltage of the battery give together."""
PARTS_OF_A_SECOND = {"nanoseconds": 1e9, "microseconds": 1e6}
"""Units in which a log may have the part of a time below its whole seconds, and how many of them a second has."""


class Source(Section):
    """Where the values of one quantity come from: from a column of the log, or a constant."""

    column: str = ""
    """Name of the column in the log, as its header has it; empty for a constant or a quaternion."""
    quaternion: Annotated[tuple[str, ...], FromList] = ()
    """Names of the columns of x, y, z and w of an orientation whose x axis is the heading, or of z and w alone."""
    nanoseconds: str = ""
    """Name of the column of nanoseconds that are added to a time in whole seconds."""
    microseconds: str = ""
    """Name of the column of microseconds that are added to it instead, as a C program has them from `gettimeofday`."""
    constant: float | str | None = None
    """Value of every row, in our unit."""
    unit: str = ""
    """Unit in the log; empty for our unit."""
    factor: float = Field(default=1.0, ge=-1e12, le=1e12)
    """Factor on the values besides the unit; -1 turns the sign."""
    offset: float = Field(default=0.0, ge=-1e6, le=1e6)
    """Number added to the values in our unit, such as a place in a room whose corner is not the origin of the log."""
    times: str = ""
    """Column by whose values in the same rows a duty cycle is multiplied, such as the voltage of the battery."""
    direction: str = ""
    """Column by whose values in the same rows a duty cycle or a voltage without a sign becomes negative."""
    backwards: Annotated[tuple[str | float, ...], FromList] = ()
    """Values of that column with which it becomes negative, such as `B` or 0."""
    time_offset_s: float = Field(default=0.0, ge=-10, le=10)
    """Time by which the values were measured later than the time of their row."""
    held: Literal["", "after_row", "before_row"] = ""
    """Whether each voltage is held from its row to the next, or was held from the row before to its row; empty for the
    usual of the kind: `before_row` in a step log, `after_row` in a drive."""
    per_row: bool = False
    """Whether each value is the number of ticks since the row before; by default counts run on."""
    wraps_at: float = Field(default=0.0, ge=0, le=1e12)
    """Number of ticks at which the counter begins again; powers of two are recognised without it."""

    @property
    def text(self) -> str:
        """Source in a few words, such as `x_mm, in mm`."""
        factor = f", times {self.factor:g}" if self.factor != 1.0 else ""
        times = f", times {self.times}" if self.times else ""
        times += f", negative where {self.direction} is {self.backwards_text}" if self.backwards else ""
        offset = f", {'plus' if self.offset > 0.0 else 'minus'} {abs(self.offset):g}" if self.offset else ""
        held = {"after_row": ", held to the next row", "before_row": ", held from the row before"}.get(self.held, "")
        quaternion = f"the quaternion {', '.join(self.quaternion)}" if self.quaternion else ""
        unit, column = self.fraction
        stamp = f" and {unit} {column}" if column else ""
        what = f"{quaternion or self.column or self.constant}{stamp}"
        return f"{what}{f', in {self.unit}' if self.unit else ''}{factor}{times}{offset}{held}"

    @property
    def backwards_text(self) -> str:
        """Values of the column of the direction that mean backwards, such as `0 or 2`."""
        return " or ".join(value if isinstance(value, str) else f"{value:g}" for value in self.backwards)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns from which the values come."""
        return tuple(
            filter(
                None, (self.column, *self.quaternion, self.nanoseconds, self.microseconds, self.times, self.direction)
            )
        )

    @property
    def fraction(self) -> tuple[str, str]:
        """Unit and column of the part of a second that is added to whole seconds; the column is empty if none is."""
        return ("microseconds", self.microseconds) if self.microseconds else ("nanoseconds", self.nanoseconds)

    def numbers(self, log: LogFile) -> Array:
        """Return the numbers (N,) of the column, NaN if missing, with the sign and times the numbers of other columns.

        Those of a quaternion are headings [rad], and those of a column with parts of a second are times [s].

        Raises:
            InputError: A cell is no number, or the columns are no quaternion or no parts of a second.
        """
        if self.quaternion:
            components = np.column_stack([log.numbers(column) for column in self.quaternion])
            return heading_of(components, str(log.path), self.quaternion)
        if self.fraction[1]:
            return self.times_of(log)
        numbers = log.numbers(self.column)
        if self.direction:
            numbers = numbers * log.signs(self.direction, self.backwards)
        return numbers * log.numbers(self.times) if self.times else numbers

    def times_of(self, log: LogFile) -> Array:
        """Return the times (N,) of the column, each of which is a number, with parts of a second added if it has them.

        Raises:
            InputError: A cell is no number, or empty, or no part of a second.
        """
        times = log.times(self.column)
        unit, column = self.fraction
        if not column:
            return times
        parts, whole = log.times(column), PARTS_OF_A_SECOND[unit]
        wrong = np.flatnonzero((parts < 0.0) | (parts >= whole) | (parts != np.rint(parts)))
        if len(wrong):
            row = int(wrong[0])
            where, got = log.where(row), log.columns[column][row]
            allowed = f"whole numbers below {whole:.0e}, since they are {unit} beside the seconds of {self.column}"
            cure = f"if they are whole times, name {column} as the column of t_s"
            raise InputError(f"column {column}", where=where, got=got, allowed=allowed, cure=cure)
        return times + parts / whole


class LogMapping(Section):
    """Content of a mapping file."""

    kind: str
    """Kind of the log, such as `drive_log` or `trajectory`."""
    header: Annotated[tuple[str, ...], FromList] = ()
    """Names of the columns of a log that has no header, from left to right; empty for a log with one."""
    columns: Annotated[dict[str, Source], Field(min_length=1)]
    """Source of each quantity by its name; quantities that are not listed were not logged."""


def read_mapping(path: Path, kinds: Sequence[LogKind], also: Sequence[str] = ()) -> LogMapping:
    """Return the content of a mapping file for a log of one of these kinds.

    Args:
        path: The file.
        kinds: Kinds that are allowed.
        also: Names of further kinds that are allowed.

    Raises:
        InputError: The file is not strict YAML or breaks the format; the message names every fault.
    """
    root, names, faults = read_yaml(path).root, [*(kind.name for kind in kinds), *also], FaultList()
    mapping = None
    try:
        content = root.plain()
        mapping = LogMapping.model_validate({"kind": "", **content} if isinstance(content, dict) else content)
    except ValidationError as error:
        faults.faults += all_explained(error, root, Shape.from_model(LogMapping))
    node = root.child("kind")
    if node is None:
        faults.faults.append(InputError("kind: missing", where=root.where, allowed=", ".join(names)))
    elif isinstance(node.value, str) and node.value not in names:
        hint = nearest(node.value, names)
        faults.faults.append(
            InputError("kind", where=node.where, got=node.value, allowed=", ".join(names), nearest=hint)
        )
    faults.check()
    assert mapping is not None  # noqa: S101 - without a fault it was read
    return mapping


def check_mapping(mapping: LogMapping, kind: LogKind, log: LogFile, where: str) -> None:
    """Refuse a mapping that does not fit the log.

    Args:
        mapping: The mapping.
        kind: Its kind.
        log: The log.
        where: Place of the mapping for messages.

    Raises:
        InputError: A column does not exist, a unit does not fit, or too few quantities are mapped; all are reported.
    """
    faults = FaultList()
    for name, source in mapping.columns.items():
        place = f"{where}: columns.{name}"
        with faults.noted():
            if name not in kind.names:
                raise InputError(
                    "no quantity that a mapping can give",
                    where=place,
                    allowed=", ".join(kind.names),
                    nearest=nearest(name, kind.names),
                )
            if [bool(source.column), bool(source.quaternion), source.constant is not None].count(True) != 1:
                also = ", a quaternion" if name == "theta_rad" else ""
                raise InputError(f"give either a column{also} or a constant", where=place)
            _check_combined(name, source, place)
            for column in source.columns:
                check_column(column, log, place)
            if source.constant is not None:
                _check_constant(name, source, place, is_number=name in kind.scales)
            if (source.per_row or source.wraps_at) and name not in COUNTED:
                what = "per_row and wraps_at are for counts of encoders"
                raise InputError(what, where=place, allowed=", ".join(COUNTED))
            _check_offset(name, source.offset, place, is_measured=name in kind.scales and name not in COUNTED)
            _check_voltage(name, source, place)
            if source.held and name not in kind.held:
                what = "held is for the voltages of a drive or of a step log"
                raise InputError(what, where=place, allowed=", ".join(VOLTAGES))
        with faults.noted():
            factor_to(kind.unit_of(name), source.unit, place)
            if unit_of(source.unit) == PERCENT and source.factor == 1.0 and not source.times:
                what = "a duty cycle in percent needs the voltage of a full one"
                raise InputError(
                    what, where=place, cure="write it as factor, such as factor: 7.4, or name its column as times"
                )
    with faults.noted():
        _check_needed(kind, mapping.columns, where)
    faults.check()


def _check_combined(name: str, source: Source, where: str) -> None:
    """Refuse a quaternion of anything but a heading, and parts of a second of anything but a time in seconds."""
    if source.quaternion and name != "theta_rad":
        raise InputError("quaternion is for theta_rad", where=where)
    if source.quaternion and len(source.quaternion) not in {2, 4}:
        allowed, got = "the columns of x, y, z and w, or of z and w", f"{len(source.quaternion)} names"
        raise InputError(f"quaternion: got {got}", where=where, allowed=allowed)
    if source.quaternion and source.unit:
        raise InputError("a quaternion has no unit", where=where, cure="leave unit out; offset is in rad")
    if source.nanoseconds and source.microseconds:
        raise InputError("nanoseconds and microseconds", where=where, allowed="one of them")
    unit, column = source.fraction
    if column and name != "t_s":
        raise InputError(f"{unit} is for t_s", where=where)
    if column and (unit_of(source.unit) or source.unit) not in {"", "s"}:
        alone = {"nanoseconds": "ns", "microseconds": "us"}[unit]
        raise InputError(
            f"{unit} are added to seconds", where=where, cure=f"leave unit out, or write unit: {alone} alone"
        )


def _check_voltage(name: str, source: Source, where: str) -> None:
    """Refuse the columns beside a duty cycle for anything but a voltage, and a sense without its column."""
    for field in ("times", "direction", "backwards"):
        if getattr(source, field) and name not in VOLTAGES:
            raise InputError(f"{field} is for voltages", where=where, allowed=", ".join(VOLTAGES))
    if source.backwards and not source.direction:
        cure = "name the column with these values as direction"
        raise InputError("backwards without direction", where=where, cure=cure)


def _check_offset(name: str, offset: float, where: str, *, is_measured: bool) -> None:
    if offset and (name == "t_s" or not is_measured):
        cure = "for a shift in time, give the others time_offset_s" if name == "t_s" else ""
        raise InputError("offset is for measured numbers other than times and counts", where=where, cure=cure)
    if name.endswith("_rad") and abs(offset) > 2.0 * pi:
        cure = f"{offset:g} degrees are {radians(offset):.4g}"
        raise InputError("offset", where=where, got=offset, allowed="at most a turn, in rad", cure=cure)


def check_column(column: str, log: LogFile, where: str) -> None:
    """Refuse a column that a log does not have; `where` names who chose it.

    Raises:
        InputError: There is no such column.
    """
    if column not in log.columns:
        what, columns = "the log has no such column", log.columns
        raise InputError(what, where=where, got=column, allowed=", ".join(columns), nearest=nearest(column, columns))


def _check_constant(name: str, source: Source, where: str, *, is_number: bool) -> None:
    if name == "t_s":
        raise InputError("the time cannot be constant", where=where, cure="name the column of the times")
    if is_number and isinstance(source.constant, str):
        raise InputError("the constant is no number", where=where, got=source.constant, allowed="a number, unquoted")
    if source != Source(constant=source.constant):
        what = "a constant takes no unit, factor, offset, times or time_offset_s"
        raise InputError(what, where=where, cure="write it in our unit")


def _check_needed(kind: LogKind, names: Mapping[str, object], where: str) -> None:
    """Refuse too few quantities for a kind of log.

    Raises:
        InputError: None of the sets of quantities that the kind needs is complete.
    """
    if not kind.suffices(names):
        raise InputError(
            f"too few columns for a log of the kind {kind.name}",
            where=where,
            got=sorted(names),
            allowed="; or ".join(" ".join(sorted(needed)) for needed in kind.needed),
            cure=f"name the column of each in {MAPPING}; a column that it does not name is not read",
        )


def unused_columns(mapping: LogMapping, log: LogFile) -> list[str]:
    """Return the columns of a log that a mapping does not use."""
    used = {name for source in mapping.columns.values() for name in source.columns}
    return [name for name in log.columns if name not in used]


def missing_note(mapping: LogMapping, log: LogFile, names: Collection[str]) -> list[str]:
    """Return a note with the number of cells without a number in the columns of these quantities, if there are any.

    Args:
        mapping: Sources of the quantities.
        log: A log whose cells can be read.
        names: Quantities that are numbers.
    """
    sources = [mapping.columns[name] for name in names if name in mapping.columns]
    columns = [column for source in sources for column in source.quaternion or (source.column,) if column]
    missing = {column: int(np.count_nonzero(np.isnan(log.numbers(column)))) for column in columns}
    counts = ", ".join(f"{count} of {column}" for column, count in missing.items() if count)
    return [f"cells without a number, of {log.rows} each: {counts}"] if counts else []


def mapping_text(mapping: LogMapping, kind: LogKind, log: LogFile, command: Sequence[str]) -> str:
    """Return the text of a mapping file, with comments that say how to change it and which command reads it."""
    unused = unused_columns(mapping, log)
    lines = [
        f"# Which column of {log.path.name} is which quantity. To change it, edit a line and run",
        f"#   {shlex.join(command)}",
        "# unit: unit in the log, such as mm, deg, ms, rpm, mV. factor: factor besides the unit; -1 turns the sign.",
        "# offset: number added to the values in our unit, such as to x_m if the corner of a room is not the origin.",
        "# quaternion: columns of x, y, z and w, in place of column. nanoseconds: column that is added to seconds.",
        "# times: column of the voltage by which a duty cycle is multiplied, row by row.",
        "# direction: column of the sense of a voltage without a sign. backwards: its values with a negative voltage.",
        "# time_offset_s: time by which the values were measured later than the time of their row.",
        "# held: after_row if each voltage is held from its row to the next, before_row if since the row before.",
        "# per_row: true, if ticks start from zero in each row. wraps_at: ticks at which a counter begins again.",
        "# A quantity that was constant: {constant: VALUE}, in the unit of its name.",
        f"kind: {mapping.kind}",
        *([f"header: {json.dumps(mapping.header, ensure_ascii=False)}"] if mapping.header else []),
        "columns:",
    ]
    for name, source in mapping.columns.items():
        # JSON is YAML: a name or number in it reads back exactly.
        fields = source.model_dump(exclude_defaults=True)
        texts = [f"{key}: {json.dumps(value, ensure_ascii=False)}" for key, value in fields.items()]
        lines.append(f"  {name}: {{{', '.join(texts)}}}")
    absent = [name for name in kind.names if name not in mapping.columns]
    lines += [f"# not used: {', '.join(unused)}"] if unused else []
    lines += [f"# not logged: {', '.join(absent)}"] if absent else []
    return "\n".join(lines) + "\n"
