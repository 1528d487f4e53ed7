"""The mapping file of a log: which of its columns, in which unit, is which quantity of a case."""

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError

from configs.schema.base import Section
from configs.schema_faults import all_explained
from configs.shapes import Shape
from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.log_file import LogFile
from diagnosis.new_case.quantities import COUNTS, NEEDED, our_columns, quantity_names
from diagnosis.new_case.units import factor_to
from symolo.core.errors import FaultList, InputError, nearest, together
from symolo.core.yaml.reader import read_yaml

MAPPING = "mapping.yaml"


class Source(Section):
    """Where the values of one column of data.csv come from: from a column of the log, or a constant."""

    column: str = ""
    """Name of the column in the log, as its header has it; empty for a constant."""
    constant: float | str | None = None
    """Value of every row, in the unit of the case."""
    unit: str = ""
    """Unit in the log; empty for the unit of the case."""
    factor: float = Field(default=1.0, ge=-1e12, le=1e12)
    """Factor on the values besides the unit; -1 turns the sign."""
    time_offset_s: float = Field(default=0.0, ge=-10, le=10)
    """Time by which the values were measured later than the time of their row."""
    per_row: bool = False
    """Whether each value is the number of ticks since the row before; by default counts run on."""
    wraps_at: float = Field(default=0.0, ge=0, le=1e12)
    """Number of ticks at which the counter begins again; powers of two are recognised without it."""


class LogMapping(Section):
    kind: Literal["motor_steady", "motor_step", "tof_bench", "drive_log"]
    columns: Annotated[dict[str, Source], Field(min_length=1)]
    """Source of each column of data.csv; columns that are not listed were not logged."""

    @property
    def case_kind(self) -> CaseKind:
        return CaseKind(self.kind)


def read_mapping(path: Path) -> LogMapping:
    """Return the content of a mapping file.

    Raises:
        InputError: The file is not strict YAML or breaks the format; the message names every fault.
    """
    root = read_yaml(path).root
    try:
        return LogMapping.model_validate(root.plain())
    except ValidationError as error:
        raise together(all_explained(error, root, Shape.of(LogMapping))) from None


def check_mapping(mapping: LogMapping, log: LogFile, where: str) -> None:
    """Refuse a mapping that does not fit the log.

    Args:
        mapping: The mapping.
        log: The log.
        where: Place of the mapping for messages.

    Raises:
        InputError: A column does not exist, a unit does not fit, or too few quantities are mapped; all are reported.
    """
    faults, kind = FaultList(), mapping.case_kind
    known, ours = quantity_names(kind), our_columns(kind)
    for name, source in mapping.columns.items():
        place = f"{where}: columns.{name}"
        with faults.noted():
            if name not in known:
                raise InputError(
                    "no column of data.csv that a mapping can give",
                    where=place,
                    allowed=", ".join(known),
                    nearest=nearest(name, known),
                )
            if bool(source.column) == (source.constant is not None):
                raise InputError("give either a column or a constant", where=place)
            if source.column and source.column not in log.columns:
                raise InputError(
                    "the log has no such column",
                    where=place,
                    got=source.column,
                    allowed=", ".join(log.columns),
                    nearest=nearest(source.column, log.columns),
                )
            if source.constant is not None:
                _check_constant(name, source, place, is_number=name in ours)
            if (source.per_row or source.wraps_at) and name not in COUNTS:
                what = "per_row and wraps_at are for counts of encoders"
                raise InputError(what, where=place, allowed=", ".join(COUNTS))
        with faults.noted():
            factor_to(ours[name].unit if name in ours else "", source.unit, place)
    with faults.noted():
        _check_needed(kind, mapping.columns, where)
    faults.check()


def _check_constant(name: str, source: Source, where: str, *, is_number: bool) -> None:
    if name == "t_s":
        raise InputError("the time cannot be constant", where=where, cure="name the column of the times")
    if is_number and isinstance(source.constant, str):
        raise InputError("the constant is no number", where=where, got=source.constant, allowed="a number, unquoted")
    if source != Source(constant=source.constant):
        what = "a constant takes no unit, factor or time_offset_s"
        raise InputError(what, where=where, cure="write it in the unit of data.csv")


def _check_needed(kind: CaseKind, names: Mapping[str, object], where: str) -> None:
    """Refuse too few quantities for a diagnosis of a kind of case.

    Raises:
        InputError: None of the sets of quantities that the kind needs is complete.
    """
    if not any(needed <= set(names) for needed in NEEDED[kind]):
        sets = [" ".join(sorted(needed)) for needed in NEEDED[kind]]
        raise InputError(
            f"too few columns for a case of the kind {kind}",
            where=where,
            got=sorted(names),
            allowed="; or ".join(sets),
            cure=f"name the column of each in {MAPPING}",
        )


def unused_columns(mapping: LogMapping, log: LogFile) -> list[str]:
    """Return the columns of a log that a mapping does not use."""
    used = {source.column for source in mapping.columns.values()}
    return [name for name in log.columns if name not in used]


def mapping_text(mapping: LogMapping, log: LogFile, out: Path) -> str:
    """Return the text of a mapping file for the folder `out`, with comments that say how to change it."""
    command = ["symolo", "case", "init", f"{log.path}", "--mapping", f"{out / MAPPING}", "--out", f"{out}-2"]
    unused = unused_columns(mapping, log)
    lines = [
        f"# Which column of {log.path.name} is which column of data.csv. To change it, edit a line and run",
        f"#   {shlex.join(command)}",
        "# unit: unit in the log, such as mm, deg, ms, rpm, mV. factor: factor besides the unit; -1 turns the sign.",
        "# time_offset_s: time by which the values were measured later than the time of their row.",
        "# per_row: true, if ticks are counted anew in each row. wraps_at: ticks at which a counter begins again.",
        "# A quantity that was constant: {constant: VALUE}, in the unit of data.csv.",
        f"kind: {mapping.kind}",
        "columns:",
    ]
    for name, source in mapping.columns.items():
        # JSON is YAML: a name or number in it reads back exactly.
        fields = source.model_dump(exclude_defaults=True)
        texts = [f"{key}: {json.dumps(value, ensure_ascii=False)}" for key, value in fields.items()]
        lines.append(f"  {name}: {{{', '.join(texts)}}}")
    absent = [name for name in quantity_names(mapping.case_kind) if name not in mapping.columns]
    lines += [f"# not used: {', '.join(unused)}"] if unused else []
    lines += [f"# not logged: {', '.join(absent)}"] if absent else []
    return "\n".join(lines) + "\n"
