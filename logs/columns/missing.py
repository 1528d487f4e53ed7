"""The error for a log that lacks columns of its kind, with a column that may be meant."""

import shlex
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from logs.columns.combined import companions
from logs.columns.drive import COUNTED
from logs.columns.quantity import LEFT, RIGHT, SET, SIDES, SPEED, LogKind, words
from logs.log_file import LogFile
from logs.mapping import MAPPING, VOLTAGES
from logs.units.names import fits, taken_apart, units_for
from symolo.core.errors import InputError

MIN_VALUES = 5
"""Smallest number of different values of a quantity that changes; a mode or a flag has fewer."""
_OTHERS = words(
    "z qx qy qz qw quat quaternion roll pitch mode state status flag error err id seq index row intensity temperature "
    "temp ultra gyro acc accel mag sec secs nsec nsecs nanosec seconds delta diff"
)
"""Words of what is no quantity of a case."""


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
    used = {*recognised.values()}
    used |= companions([*log.columns], kind.fillers, used)
    unused = [name for name in log.columns if name not in used]
    cure = f"rename them, or write a {MAPPING} ({kind.page}) and name it with {kind.mapping_option}{kind.elsewhere}"
    if kind.column_option and unused:
        first = _example(log, kind, sets, unused)
        example = f", such as {shlex.join([kind.column_option, first])}" if first else ""
        none = f"none of these seems to be one; if one is, name it with {kind.column_option} QUANTITY=COLUMN"
        cure = f"{f'name the column of each{example}' if first else none}; or {cure}"
    others = f"not recognised: {', '.join(unused)}; " if unused else ""
    if speeds := [name for name in unused if any({*COUNTED} & each for each in sets) and _is_speed_of_wheel(name)]:
        others += f"a speed of a wheel, such as {speeds[0]}, cannot take the place of its count: log the counts, or "
    return InputError(
        f"no column was recognised as {names}, which a log of the kind {kind.name} needs",
        where=log.header_where,
        cure=f"{others}{cure}",
    )


def _is_speed_of_wheel(column: str) -> bool:
    """Return whether the name of a column is that of the speed of one wheel."""
    header = taken_apart(column)
    is_speed = header.unit in {*units_for("rad/s"), *units_for("m/s")} or SPEED & {*header.words}
    return bool(is_speed and (LEFT | RIGHT) & {*header.words})


def _example(log: LogFile, kind: LogKind, sets: Sequence[Collection[str]], unused: Sequence[str]) -> str:
    """Return a quantity that is missing and a column that may hold it; empty if no column may."""
    for lacking in sets:
        for name in sorted(lacking, key=kind.names.index):
            possible = [column for column in unused if _may_hold(log, column, name, kind)]
            named = [column for column in possible if _is_named(column, name, kind)]
            if columns := [*named, *possible]:
                return f"{name}={columns[0]}"
    return ""


def _is_named(column: str, name: str, kind: LogKind) -> bool:
    """Return whether the name of a column has a word of a quantity besides its side, or a unit."""
    header = taken_apart(column)
    last = {word for each in kind.quantities if each.name == name for word in each.groups[-1]}
    return bool(last & {*header.words}) or (bool(header.unit) and name not in COUNTED)


def _may_hold(log: LogFile, column: str, name: str, kind: LogKind) -> bool:
    """Return whether a column has a name, a unit and numbers that a quantity may have."""
    header = taken_apart(column)
    if not fits(header, kind.unit_of(name)) or _OTHERS & {*header.words}:
        return False
    here = {word for each in kind.quantities if each.name == name for group in each.groups for word in group}
    here |= SIDES | (SET if name in VOLTAGES else frozenset())
    others = {word for each in kind.quantities for group in each.groups for word in group} - here
    if others & {*header.words}:
        return False
    try:
        numbers = log.numbers(column)
    except InputError:
        return False
    known = numbers[np.isfinite(numbers)]
    if name == "t_s":
        return len(known) == len(numbers) and len(known) > 1 and bool(np.all(np.diff(known) > 0.0))
    if name in COUNTED and np.any(known != np.rint(known)):
        return False
    is_held = name in VOLTAGES or name == "distance_m"
    return len(np.unique(known)) >= (1 if is_held else min(MIN_VALUES, log.rows))
