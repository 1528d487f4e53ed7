"""The error for a log that lacks columns of its kind, with a column that may be meant."""

import shlex
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from logs.drive import COUNT_WORDS, COUNTED
from logs.log_file import LogFile
from logs.mapping import MAPPING
from logs.quantity import LogKind
from logs.units import fits, taken_apart
from symolo.core.errors import InputError


def missing(log: LogFile, kind: LogKind, recognised: Mapping[str, str]) -> InputError:
    """Return an error that names what is missing of each set of quantities that would do, the nearest one first.

    A range is named only if it alone is missing, and then beside what else would do.
    """
    order = sorted(kind.needed, key=lambda needed: -len(needed.intersection(recognised)))
    several = [needed.difference(recognised) for needed in order]
    without_range = [lacking for lacking in several if not lacking & kind.ranges] or several
    lone_range = [lacking for lacking in several if lacking <= kind.ranges][:1]
    sets = [each for each in dict.fromkeys((*without_range, *lone_range)) if not any(other < each for other in several)]
    order_of_name = kind.names.index
    names = ", or else as ".join(" ".join(sorted(each, key=order_of_name)) for each in sets)
    unused = [name for name in log.columns if name not in recognised.values()]
    cure = f"rename them, or write a {MAPPING} ({kind.page}) and name it with {kind.mapping_option}{kind.elsewhere}"
    if kind.column_option and unused:
        first = _example(log, kind, sets, unused)
        example = f", such as {shlex.join([kind.column_option, first])}" if first else ""
        form = "" if first else f" with {kind.column_option} QUANTITY=COLUMN"
        cure = f"name the column of each{form}{example}; or {cure}"
    others = f"not recognised: {', '.join(unused)}; " if unused else ""
    return InputError(
        f"no column was recognised as {names}, which a log of the kind {kind.name} needs",
        where=log.header_where,
        cure=f"{others}{cure}",
    )


def _example(log: LogFile, kind: LogKind, sets: Sequence[Collection[str]], unused: Sequence[str]) -> str:
    """Return a quantity that is missing and a column that may hold it; empty if no column may."""
    for lacking in sets:
        for name in sorted(lacking, key=kind.names.index):
            possible = [column for column in unused if _may_hold(log, column, name, kind.unit_of(name))]
            counts = [column for column in possible if COUNT_WORDS & {*taken_apart(column).words}]
            stated = [column for column in possible if taken_apart(column).unit]
            if columns := [*(counts if name in COUNTED else stated), *possible]:
                return f"{name}={columns[0]}"
    return ""


def _may_hold(log: LogFile, column: str, name: str, unit: str) -> bool:
    """Return whether a column has numbers, increasing ones of a time, and no unit that the quantity cannot have."""
    if not fits(taken_apart(column), unit):
        return False
    try:
        numbers = log.numbers(column)
    except InputError:
        return False
    known = numbers[np.isfinite(numbers)]
    if name == "t_s":
        return len(known) == len(numbers) and len(known) > 1 and bool(np.all(np.diff(known) > 0.0))
    return len(known) > 0
