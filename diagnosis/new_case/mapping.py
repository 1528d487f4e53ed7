"""The mapping file of a log: which of its columns, in which unit, is which quantity of a case."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError

from configs.schema.base import Section
from configs.schema_faults import all_explained
from configs.shapes import Shape
from diagnosis.measured.case_format import COLUMNS
from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.log_file import LogFile
from diagnosis.new_case.quantities import NEEDED, our_columns
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
    known = [column.name for column in COLUMNS[kind]]
    for name, source in mapping.columns.items():
        place = f"{where}: columns.{name}"
        with faults.noted():
            if name not in known:
                raise InputError(
                    "no column of data.csv", where=place, allowed=", ".join(known), nearest=nearest(name, known)
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
        with faults.noted():
            ours = our_columns(kind)
            factor_to(ours[name].unit if name in ours else "", source.unit, place)
    with faults.noted():
        check_needed(kind, mapping.columns, where)
    faults.check()


def check_needed(kind: CaseKind, names: Mapping[str, object], where: str) -> None:
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


def mapping_text(mapping: LogMapping, log: LogFile, out: Path) -> str:
    """Return the text of a mapping file, with comments that say how to change it."""
    ignored = [name for name in log.columns if name not in {source.column for source in mapping.columns.values()}]
    ours = our_columns(mapping.case_kind)
    lines = [
        f"# Which column of {log.path.name} is which column of data.csv. To change it, edit a line and run",
        f"#   symolo case init {log.path} --mapping {MAPPING} --out {out}-2",
        "# unit: unit in the log, such as mm, deg, ms, rpm, mV. factor: factor besides the unit; -1 turns the sign.",
        "# time_offset_s: time by which the values were measured later than the time of their row.",
        "# A quantity that was constant: {constant: VALUE}, in the unit of data.csv.",
        f"kind: {mapping.kind}",
        "columns:",
    ]
    for name, source in mapping.columns.items():
        fields = {"column": f'"{source.column}"'} if source.column else {"constant": f"{source.constant}"}
        fields |= {"unit": f'"{source.unit}"'} if source.unit else {}
        fields |= {"factor": f"{source.factor:.10g}"} if source.factor != 1.0 else {}
        fields |= {"time_offset_s": f"{source.time_offset_s:g}"} if source.time_offset_s else {}
        lines.append(f"  {name}: {{{', '.join(f'{key}: {value}' for key, value in fields.items())}}}")
    absent = [name for name in ours if name not in mapping.columns]
    lines += [f"# not used: {', '.join(ignored)}"] if ignored else []
    lines += [f"# not logged: {', '.join(absent)}"] if absent else []
    return "\n".join(lines) + "\n"
