"""Proposal of a mapping for the log of a case whose kind follows from its columns."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.quantities import COLUMN_OPTION, KINDS, STEADY_FROM_S, STEP_S, UNIT_OPTION, wheel_columns
from logs.columns.drive import COUNTED
from logs.columns.missing import missing
from logs.columns.proposal import Proposal, propose_as
from logs.columns.quantity import LEFT, RIGHT, SIDES
from logs.columns.stamp import stamp_source
from logs.log_file import LogFile
from logs.mapping import MAPPING, Source, check_column
from logs.units.guessed import Reading, asked, time_units, usual_step_of
from logs.units.names import NO_UNIT_WORDS, HeaderName, factor_to, fits, taken_apart, unit_of, units_for
from symolo.core.errors import FaultList, InputError, nearest

_MOTORS = (CaseKind.MOTOR_STEP, CaseKind.MOTOR_STEADY)
USUAL_NAMES = "time_ms, pwm, voltage [V], current_mA, rpm, encL, x [mm], heading_deg, range_cm"
"""Names of columns in logs of others, one for each quantity that most logs have."""


def chosen_columns(
    settings: Sequence[str],
    log: LogFile,
    kind: CaseKind | None = None,
    units: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, str]:
    """Return the columns that a user chose, by quantity.

    Args:
        settings: Texts such as `t_s=loop_ms`.
        log: The log.
        kind: Kind of the case; None if it is recognised from the columns.
        units: Units that the user stated, by quantity, in place of those in the names.

    Raises:
        InputError: A text has another form, or names a quantity or a column that does not exist, or one of them twice.
    """
    form = f"QUANTITY=COLUMN, such as t_s={next(iter(log.columns))}"
    chosen = _by_quantity(settings, COLUMN_OPTION, form, kind)
    for name, column in chosen.items():
        where = f"{COLUMN_OPTION} {name}"
        check_column(column, log, where)
        other = next(other for other, one in chosen.items() if one == column)
        if other != name:
            raise InputError(f"the column of {other}, too", where=where, got=column)
        if name not in units:
            _check_unit(name, column)
    return chosen


def stated_units(settings: Sequence[str], kind: CaseKind | None = None) -> dict[str, str]:
    """Return the units that a user stated in texts such as `t_s=ms`, by quantity.

    Raises:
        InputError: A text has another form, or names a quantity that does not exist, or one of them twice.
    """
    return _by_quantity(settings, UNIT_OPTION, "QUANTITY=UNIT, such as u_left_V=mV", kind)


def _by_quantity(settings: Sequence[str], option: str, form: str, kind: CaseKind | None) -> dict[str, str]:
    """Return the texts behind the equals signs of settings of an option, by the quantity before it."""
    names = sorted({name for one in KINDS for name in KINDS[one].names if kind in {None, one}})
    log_kind = f"a {kind}" if kind else "a log"
    chosen: dict[str, str] = {}
    for text in settings:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise InputError(option, got=text, allowed=form)
        if name not in names:
            what = f"{option}: no quantity of {log_kind}"
            raise InputError(what, got=name, allowed=", ".join(names), nearest=nearest(name, names))
        if name in chosen:
            cure = f"name one {'column' if option == COLUMN_OPTION else 'unit'} for each quantity"
            raise InputError("given twice", where=f"{option} {name}", cure=cure)
        chosen[name] = value
    return chosen


def _check_unit(name: str, column: str) -> None:
    """Refuse a chosen column whose name states a unit that the quantity cannot have.

    Raises:
        InputError: The name does so.
    """
    ours = next((unit for one in KINDS if (unit := KINDS[one].unit_of(name))), "")
    header, where = taken_apart(column), f"{COLUMN_OPTION} {name}={column}"
    file = f"write a {MAPPING} with its unit or factor (docs/case_from_log.md) and name it with --mapping"
    if column == name:
        return
    if not fits(header, ours):
        state = f"states {header.unknown}, which is no known unit"
        state = f"seems to state the unit {header.unit}" if header.unit else state
        cure = (
            f"if it is in {ours} all the same, add {UNIT_OPTION} {name}={ours}; otherwise rename the column, or {file}"
        )
        if name in COUNTED and header.unit == "turns":
            cure += ", such as factor: 1440 for turns of 1440 ticks each"
        raise InputError(f"the name of the column {state}", where=where, allowed=", ".join(units_for(ours)), cure=cure)
    if word := _may_be_unit(name, header):
        what = f"the name of the column may state the unit {word}, which is not known"
        cure = f"state the unit, such as {UNIT_OPTION} {name}={ours}, or {file}"
        raise InputError(what, where=where, allowed=", ".join(units_for(ours)), cure=cure)


def _may_be_unit(name: str, header: HeaderName) -> str:
    """Return the last word of a name that means a quantity without it, and says nothing that is known; else nothing."""
    *first, last = header.words or ("",)
    for kind in KINDS.values():
        ours = kind.unit_of(name)
        is_known = last in kind.fillers | NO_UNIT_WORDS or last.isdecimal()
        named = [each for each in kind.quantities if each.name == name]
        if header.unit or is_known or not named or len(units_for(ours)) == 1:
            continue
        words = {word for each in kind.quantities for group in each.groups for word in group}
        if last not in words and any(each.matches(HeaderName((*first,), ""), ours, kind.fillers) for each in named):
            return last
    return ""


def propose(
    log: LogFile,
    kind: CaseKind | None = None,
    supply_V: float | None = None,
    chosen: Mapping[str, str] = MappingProxyType({}),
    units: Mapping[str, str] = MappingProxyType({}),
) -> Proposal:
    """Return a mapping for the log of a case.

    Args:
        log: The log.
        kind: Kind of the case; recognised from the columns by default.
        supply_V: Voltage of a duty cycle of 1, if it is known.
        chosen: Columns that the user chose, by quantity.
        units: Units that the user stated, by quantity.

    Raises:
        InputError: The columns of no kind, or not those of this one, are in the log, or several units are as likely.
    """
    if kind in {None, CaseKind.DRIVE_LOG}:
        _check_wheels(log, chosen)
    faults = FaultList()
    log_kind = kind or _kind(log, chosen)
    columns = KINDS[log_kind].matched(log.clocks_last, chosen)
    for name in (name for name in units if name not in columns):
        cure = f"name it with {COLUMN_OPTION} {name}=COLUMN, or leave the unit out"
        with faults.noted():
            raise InputError(f"no column was recognised as {name}", where=f"{UNIT_OPTION} {name}", cure=cure)
    if kind is None and log_kind in _MOTORS and "t_s" in columns:
        with faults.noted():
            log_kind = _motor_kind(log, columns["t_s"], units.get("t_s", ""))
    with faults.noted():
        proposal = propose_as(log, KINDS[log_kind], supply_V, chosen=chosen, units=units)
    faults.check()
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
    others = wheel_columns([name for name in log.columns if name not in chosen.values()])
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
    columns_of_kind = {kind: KINDS[kind].matched(log.clocks_last, chosen) for kind in KINDS}
    fitting = [kind for kind in KINDS if KINDS[kind].suffices(columns_of_kind[kind])]
    closest = max(KINDS, key=lambda kind: len(columns_of_kind[kind]))
    if not fitting and len(columns_of_kind[closest]) > 1:
        any_motor = replace(KINDS[CaseKind.MOTOR_STEADY], name=" or ".join(_MOTORS))
        raise missing(log, any_motor if closest in _MOTORS else KINDS[closest], columns_of_kind[closest])
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
    return CaseKind.MOTOR_STEADY if best in _MOTORS else best


def _motor_kind(log: LogFile, column: str, unit: str) -> CaseKind:
    """Return whether the rows of a motor's log are samples against time or steady states, by the time between them.

    Args:
        log: The log.
        column: Column of the times.
        unit: Unit that the user stated; empty for that of the name or the values.

    Raises:
        InputError: The times may be in several units, and so be both.
    """
    unit = (
        (unit_of(unit) or unit) or taken_apart(column).unit or ("s" if column == "t_s" or column in log.clocks else "")
    )
    source = stamp_source(log, column, KINDS[CaseKind.MOTOR_STEADY].fillers) or Source(column=column)
    unit, times = "s" if source.fraction[1] else unit, source.times_of(log)
    if unit and unit not in units_for("s"):
        return CaseKind.MOTOR_STEADY  # the unit is refused with those of the others
    units = [unit] if unit else time_units(times, (STEP_S[_MOTORS[0]][0], STEP_S[_MOTORS[1]][1]))
    steps_s = {unit: factor_to("s", unit, column) * usual_step_of(times) for unit in units}
    if len(units) > 1:
        meanings = {True: "samples of a step log (motor_step)", False: "each a steady state (motor_steady)"}
        readings = [
            Reading(unit, f"rows are {step_s:.4g} s apart, {meanings[step_s < STEADY_FROM_S]}")
            for unit, step_s in steps_s.items()
        ]
        shown = f"rows that are {steps_s[units[0]] / factor_to('s', units[0], column):.6g} apart"
        raise asked(log, KINDS[CaseKind.MOTOR_STEADY], "t_s", column, shown=shown, readings=readings)
    return CaseKind.MOTOR_STEP if steps_s[units[0]] < STEADY_FROM_S else CaseKind.MOTOR_STEADY
