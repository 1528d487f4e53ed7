"""Proposal of a mapping for the log of a case whose kind follows from its columns."""

import shlex
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.quantities import COLUMN_OPTION, KINDS, of_wheels
from logs.drive import COUNTED
from logs.log_file import LogFile
from logs.mapping import MAPPING, Source, check_column
from logs.proposal import Proposal, missing, propose_as, time_step_s
from logs.quantity import LEFT, RIGHT, SIDES
from logs.units import fits, taken_apart, units_for
from symolo.core.errors import InputError, nearest

STEADY_FROM_S = 0.25
"""Time between two rows from which a log of a motor has one steady state in each row."""

USUAL_NAMES = "time_ms, pwm, voltage [V], current_mA, rpm, encL, x [mm], heading_deg, range_cm"
"""Names of columns in logs of others, one for each quantity that most logs have."""


def chosen_columns(settings: Sequence[str], log: LogFile, kind: CaseKind | None = None) -> dict[str, str]:
    """Return the columns that a user chose, by quantity.

    Args:
        settings: Texts such as `t_s=loop_ms`.
        log: The log.
        kind: Kind of the case; None if it is recognised from the columns.

    Raises:
        InputError: A text has another form, or names a quantity or a column that does not exist, or one of them twice.
    """
    names = sorted({name for one in KINDS for name in KINDS[one].names if kind in {None, one}})
    of_kind = f"a {kind}" if kind else "a log"
    chosen: dict[str, str] = {}
    for text in settings:
        name, equals, column = (part.strip() for part in text.partition("="))
        where = f"{COLUMN_OPTION} {name}"
        if not equals:
            allowed = f"QUANTITY=COLUMN, such as t_s={next(iter(log.columns))}"
            raise InputError(COLUMN_OPTION, got=text, allowed=allowed)
        if name not in names:
            what = f"{COLUMN_OPTION}: no quantity of {of_kind}"
            raise InputError(what, got=name, allowed=", ".join(names), nearest=nearest(name, names))
        if name in chosen:
            raise InputError("given twice", where=where, cure="name one column for each quantity")
        check_column(column, log, where)
        if other := next((other for other, one in chosen.items() if one == column), ""):
            raise InputError(f"the column of {other}, too", where=where, got=column)
        _check_unit(name, column)
        chosen[name] = column
    return chosen


def _check_unit(name: str, column: str) -> None:
    """Refuse a chosen column whose name states a unit that the quantity cannot have.

    Raises:
        InputError: The name does so.
    """
    ours = next((unit for one in KINDS if (unit := KINDS[one].unit_of(name))), "")
    header = taken_apart(column)
    if column == name or fits(header, ours):
        return
    state = (
        f"seems to state the unit {header.unit}" if header.unit else f"states {header.unknown}, which is no known unit"
    )
    raise InputError(
        f"the name of the column {state}",
        where=f"{COLUMN_OPTION} {name}={column}",
        allowed=", ".join(units_for(ours)),
        cure=f"rename the column, or write a {MAPPING} with its unit or factor (docs/case_from_log.md) and name it with"
        " --mapping",
    )


def propose(
    log: LogFile,
    kind: CaseKind | None = None,
    supply_V: float | None = None,
    chosen: Mapping[str, str] = MappingProxyType({}),
) -> Proposal:
    """Return a mapping for the log of a case.

    Args:
        log: The log.
        kind: Kind of the case; recognised from the columns by default.
        supply_V: Voltage of a duty cycle of 1, if it is known.
        chosen: Columns that the user chose, by quantity.

    Raises:
        InputError: The columns of no kind, or not those of this one, are in the log.
    """
    if kind in {None, CaseKind.DRIVE_LOG}:
        _check_wheels(log, chosen)
    proposal = propose_as(log, KINDS[kind or _kind(log, chosen)], supply_V, chosen=chosen)
    front = proposal.mapping.columns.get("tof_front_m", Source()).column
    if front in {"", "tof_front_m", chosen.get("tof_front_m")} or SIDES & set(taken_apart(front).words):
        return proposal
    guess = f"{front} (tof_front_m): taken for the sensor in front; else rename it in {MAPPING}"
    return Proposal(proposal.mapping, (*proposal.warnings, guess))


def _check_wheels(log: LogFile, chosen: Mapping[str, str]) -> None:
    """Refuse a log of a robot with more than two driven wheels.

    Raises:
        InputError: More than two columns are counts of encoders.
    """
    if all(name in chosen for name in COUNTED):
        return
    others = of_wheels([name for name in log.columns if name not in chosen.values()])
    wheels = [column for column in others if _side(column) not in chosen]
    wheels += [chosen[name] for name in COUNTED if name in chosen]
    if len(wheels) > 2:
        named = {_side(column): column for column in reversed(wheels)} | dict(chosen)
        pair = [f"{name}={named.get(name, 'COLUMN')}" for name in COUNTED]
        raise InputError(
            f"counts of {len(wheels)} wheels: {', '.join(wheels)}",
            where=log.header_where,
            allowed="one left and one right wheel on a common axle, which is all that the simulator can drive",
            cure="if two of the wheels are such a pair, or each side has several wheels on one motor, choose them with"
            f" {shlex.join(word for text in pair for word in (COLUMN_OPTION, text))}; if a column is no count, name"
            f" what it is with {COLUMN_OPTION} QUANTITY=COLUMN; a robot with three omnidirectional wheels cannot be"
            " compared",
        )


def _side(column: str) -> str:
    """Return the count of the one side that a name states; empty if it states none or both."""
    names = set(taken_apart(column).words)
    sides = [name for name, side in zip(COUNTED, (LEFT, RIGHT), strict=True) if names & side]
    return sides[0] if len(sides) == 1 else ""


def _kind(log: LogFile, chosen: Mapping[str, str]) -> CaseKind:
    """Return the kind whose needs the columns meet, and most of whose quantities they hold."""
    columns_of_kind = {kind: KINDS[kind].matched(list(log.columns), chosen) for kind in KINDS}
    fitting = [kind for kind in KINDS if KINDS[kind].suffices(columns_of_kind[kind])]
    closest = max(KINDS, key=lambda kind: len(columns_of_kind[kind]))
    if not fitting and len(columns_of_kind[closest]) > 1:
        raise missing(log, KINDS[closest], columns_of_kind[closest])
    if not fitting:
        line = f'`t_s: {{column: "{next(iter(log.columns))}"}}`'
        raise InputError(
            "cannot recognise what was logged from the names of the columns",
            where=log.header_where,
            got=list(log.columns),
            allowed="; ".join(f"for {kind}: {' '.join(sorted(KINDS[kind].needed[0]))}" for kind in KINDS),
            cure=f"name each with {COLUMN_OPTION} QUANTITY=COLUMN, or rename the columns (usual names such as"
            f" {USUAL_NAMES} are recognised, too), or write a {MAPPING} with lines such as {line}"
            " (docs/case_from_log.md#correct-the-mapping) and name it with --mapping",
        )
    best = max(fitting, key=lambda kind: len(columns_of_kind[kind]))
    if best in {CaseKind.MOTOR_STEP, CaseKind.MOTOR_STEADY}:
        return (
            CaseKind.MOTOR_STEP
            if _is_fast(log, columns_of_kind[CaseKind.MOTOR_STEP].get("t_s", ""))
            else CaseKind.MOTOR_STEADY
        )
    return best


def _is_fast(log: LogFile, column: str) -> bool:
    """Return whether the rows of a motor's log are samples against time, rather than steady states."""
    return bool(column) and time_step_s(log, column) < STEADY_FROM_S
