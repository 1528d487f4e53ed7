"""Proposal of a mapping for a log: columns from the names, units from the names or from the values."""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from logs.columns.combined import quaternion_columns
from logs.columns.direction import mark_directions
from logs.columns.drive import COUNTED, PER_ROW
from logs.columns.missing import missing
from logs.columns.quantity import CLOCKWISE, DUTY, SENSE, LogKind, QuantityScale
from logs.columns.quaternion_heading import ordered, tilt_note
from logs.columns.stamp import stamp_source
from logs.counts import are_per_row
from logs.log_file import LogFile
from logs.mapping import MAPPING, LogMapping, Source
from logs.units.guessed import (
    FULL_DUTIES,
    OTHER_WHEEL,
    SMALLEST_V,
    USUAL_SUPPLY_V,
    Known,
    UnknownUnitError,
    asked,
    battery_advice,
    duty_unit,
    full_duty,
    guessed,
    readings_of_duty,
)
from logs.units.names import PERCENT, HeaderName, factor_to, taken_apart, unit_of, units_for
from logs.units.plausible import OTHER_UNITS, beyond_scale, likely_unit
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError, nearest

MIN_MILLIVOLTS = 1023.0
"""Largest value of a column from which on it may be in millivolts rather than a duty cycle of 10 bit."""
SAME = 1e-3
"""Relative difference up to which two factors are those of one unit."""
GEAR_ADVICE = (
    "if it is the speed of the motor's shaft, divide it by the gear ratio, such as factor: 0.00833 for a ratio of 120"
)


@dataclass(frozen=True)
class Proposal:
    """A mapping for a log, with what was guessed."""

    mapping: LogMapping
    warnings: tuple[str, ...]
    """Guesses that the user has to check, in one sentence each."""


def propose_as(
    log: LogFile,
    kind: LogKind,
    supply_V: float | None = None,
    left_open: Collection[str] = (),
    *,
    chosen: Mapping[str, str] = MappingProxyType({}),
    units: Mapping[str, str] = MappingProxyType({}),
) -> Proposal:
    """Return a mapping for a log of a kind.

    Args:
        log: The log.
        kind: Kind of the log.
        supply_V: Voltage of a duty cycle of 1, if it is known.
        left_open: Quantities whose unit the caller guesses if no name states it.
        chosen: Columns that the user chose, by quantity.
        units: Units that the user stated, by quantity.

    Raises:
        InputError: The log lacks columns of this kind, or several units of a column are as likely; all are reported.
    """
    recognised = kind.matched(log.clocks_last, chosen)
    if not kind.suffices(recognised):
        raise missing(log, kind, recognised)
    sources: dict[str, Source] = {}
    warnings: list[str] = []
    faults = FaultList()
    known = Known(sources, recognised, supply_V)
    units = _of_both_wheels(units, recognised)
    for name, column in recognised.items():
        if name not in chosen and kind.is_by_unit(name, column):
            warnings.append(
                f"{column} ({name}): recognised by its unit alone; if it is something else, correct it in {MAPPING}"
            )
        with faults.noted():
            try:
                source, reason = _source(log, kind, name, column, known, units.get(name), is_open=name in left_open)
            except InputError as error:
                others = {other: each for other, each in recognised.items() if other != name}
                if name in chosen or name in units or not _may_lack(kind, name, others, error):
                    raise
                warnings.append(f"{column} ({name}): used for no quantity; {error}")
                continue
            warnings += [f"{', '.join(source.columns)} ({name}): {reason}"] if reason else []
            sense = -1.0 if name == "theta_rad" and _is_clockwise(taken_apart(column)) else 1.0
            sources[name] = source.model_copy(update={"factor": sense * source.factor})
    faults.check()
    _mark_per_row(log, sources, warnings)
    with faults.noted():
        mark_directions(log, sources, warnings, kind)
    faults.check()
    mapping = {"kind": kind.name, "header": log.names, "columns": sources}
    return Proposal(LogMapping.model_validate(mapping), tuple(warnings))


def _source(  # noqa: PLR0917 - what decides on the unit of one column
    log: LogFile, kind: LogKind, name: str, column: str, known: Known, unit: str | None, *, is_open: bool
) -> tuple[Source, str]:
    """Return the source of a quantity and a note: from several columns, in the stated unit, or by name and values.

    Args:
        log: The log.
        kind: Kind of the log.
        name: The quantity.
        column: Its column, or the first one of several.
        known: What is known of the log.
        unit: Unit that the user stated; None without one.
        is_open: Whether the caller guesses the unit if the name states none.

    Raises:
        InputError: The columns or the unit cannot be those of the quantity, or the unit is not known.
    """
    if combined := _combined(log, kind, name, column, unit or ""):
        return combined
    if unit is not None:
        return _stated(kind, name, column, unit, known.supply_V)
    if is_open and not taken_apart(column).unit:
        return Source(column=column), ""
    return _recognised(log, kind, name, column, known)


def _recognised(log: LogFile, kind: LogKind, name: str, column: str, known: Known) -> tuple[Source, str]:
    """Return the source of a quantity with the unit that its name or its values show, and the reason for a guess.

    Raises:
        UnknownUnitError: Neither shows it.
    """
    header = taken_apart(column)
    unit, ours, reason = header.unit if column != name else "", kind.unit_of(name), ""
    if unit == PERCENT:
        return Source(column=column, unit=unit, factor=known.supply_V or USUAL_SUPPLY_V), (
            f"a duty cycle in percent, times {_supply_text(kind, known.supply_V)}"
        )
    if DUTY & set(header.words) and not unit:
        factor, reason = _duty_factor(log, kind, name, known)
        return Source(column=column, factor=factor), reason
    if unit == "degrees" and column.lower().rstrip(" )]").endswith("grad"):
        reason = f"taken for degrees; if a turn has 400, write unit: gon in {MAPPING}"
    if ours and not unit and column != name:
        try:
            unit, why = guessed(log, kind, name, column, known)
            reason = f"the name has no unit; {why}" if why else ""
        except UnknownUnitError:
            raise
        except InputError:  # wrong cells are reported together, when the rows are read
            pass
    return Source(column=column, unit="" if unit == ours else unit), reason


def _may_lack(kind: LogKind, name: str, others: Mapping[str, str], error: InputError) -> bool:
    """Return whether a log does without a quantity for which its columns are no good.

    That is an orientation without a place, as of an inertial sensor that lies on its side.
    """
    if isinstance(error, UnknownUnitError):
        return not kind.unit_option
    return name == "theta_rad" and not {"x_m", "y_m"} <= others.keys() and kind.suffices(others)


def _combined(log: LogFile, kind: LogKind, name: str, column: str, unit: str) -> tuple[Source, str] | None:
    """Return the source of a quantity that several columns give, and a note; None if it has one column.

    Raises:
        InputError: The order of the components of a quaternion is not known, they are none, or another unit is stated.
    """
    stamp = stamp_source(log, column, kind.fillers) if name == "t_s" else None
    quaternion = quaternion_columns([*log.columns], kind.fillers)
    names = stamp.columns if stamp else quaternion if name == "theta_rad" else ()
    if column not in names:
        return None
    where, ours = str(log.path), kind.unit_of(name)
    if unit and unit_of(unit) != ours:
        what = f"{', '.join(names)} give {name} in {ours}"
        raise InputError(what, where=f"{kind.unit_option} {name}", got=unit, cure="leave the unit out")
    if stamp:
        return stamp, ""
    if len(names) == 4 and any(character.isdecimal() for character in names[0]):
        names = ordered(np.column_stack([log.numbers(each) for each in names]), names, where)
    components = np.column_stack([log.numbers(each) for each in names])
    return Source(quaternion=names), tilt_note(components, where, names)


def _stated(kind: LogKind, name: str, column: str, unit: str, supply_V: float | None) -> tuple[Source, str]:
    """Return the source of a quantity in the unit that the user stated, and a note on the voltage of a duty cycle.

    Raises:
        InputError: The quantity cannot be in this unit.
    """
    ours = kind.unit_of(name)
    if ours == "V" and (full := full_duty(unit_of(unit) or unit)):
        is_percent = unit_of(unit) == PERCENT
        factor = (supply_V or USUAL_SUPPLY_V) / (1.0 if is_percent else full)
        reason = f"a duty cycle of which {full:g} is full, times {_supply_text(kind, supply_V)}"
        return Source(column=column, unit=PERCENT if is_percent else "", factor=factor), reason
    where = f"{kind.unit_option} {name}"
    if (unit_of(unit) or unit) not in units_for(ours):
        duties = map(duty_unit, FULL_DUTIES) if ours == "V" else ()
        names = [*dict.fromkeys((*units_for(ours), *duties))] if ours else []
        allowed = ", ".join(names) or "none, because the quantity has no unit"
        raise InputError(where, got=unit, allowed=allowed, nearest=nearest(unit, names))
    return Source(column=column, unit="" if unit_of(unit) == ours else unit_of(unit)), ""


def _mark_per_row(log: LogFile, sources: dict[str, Source], warnings: list[str]) -> None:
    """Mark the counts that are those since the row before, with a sentence for each."""
    for name in [name for name in COUNTED if name in sources and _are_per_row(log, name, sources)]:
        column = sources[name].column
        sources[name] = sources[name].model_copy(update={"per_row": True})
        is_named = PER_ROW & set(taken_apart(column).words)
        reason = "by its name" if is_named else "because it rises and falls with the speed"
        warnings.append(f"{column} ({name}): taken for the ticks since the row before, {reason}")


def unit_faults(mapping: LogMapping, kind: LogKind, values: Mapping[str, Array], log: LogFile) -> Sequence[InputError]:
    """Return an error for each quantity that no robot can have in the unit that the mapping states."""
    faults = []
    for name, scale in kind.scales.items():
        typical = beyond_scale(values[name], scale.plausible) if name in values else None
        if typical is None:
            continue
        source = mapping.columns[name]
        factor = _likely(typical, scale, source) or "check its unit"
        if name == "omega_rad_s":
            factor += f"; {GEAR_ADVICE}"
        cure = f"{factor}; correct its unit in {MAPPING} and give that with {kind.mapping_option}"
        if DUTY & set(taken_apart(source.column).words):
            cure = (
                f"if it is a duty cycle, add the volts of a value of 1 in {MAPPING}, such as factor: 0.029 for 7.4 V "
                f"at 255, and give that with {kind.mapping_option}"
            )
        faults.append(
            InputError(
                f"column {source.column or source.constant}: as {source.unit or scale.unit} it gives {name} around "
                f"{typical:.4g} {scale.unit}",
                where=str(log.path),
                allowed=scale.plausible.words(scale.unit),
                cure=cure,
            )
        )
    return faults


def _likely(typical: float, scale: QuantityScale, source: Source) -> str:
    """Return advice that names other units of the column than the stated one; empty if none would be possible."""
    stated = factor_to(scale.unit, source.unit, source.column)
    if stated == 1.0:
        return likely_unit(typical, scale.plausible, scale.unit)
    in_column = typical / stated
    units = ((scale.unit, 1.0), *OTHER_UNITS.get(scale.unit, ()))
    fits = [
        unit
        for unit, per in units
        if abs(per * stated - 1.0) > SAME and scale.plausible.low <= in_column / per <= scale.plausible.high
    ]
    return f"the values would be possible in {' or '.join(fits)}" if fits else ""


def _are_per_row(log: LogFile, name: str, sources: Mapping[str, Source]) -> bool:
    """Return whether a column has the ticks since the row before, by its name or because it follows the speed."""
    column = sources[name].column
    if PER_ROW & set(taken_apart(column).words):
        return True
    if column == name:
        return False
    try:
        counts = log.numbers(column)
        if (voltage := sources.get(f"u_{name.split('_')[1]}_V")) is not None and voltage.column:
            volts = log.numbers(voltage.column)
            # Without a sign, a voltage is as large backwards as forwards.
            return are_per_row(counts if np.any(volts < 0.0) else np.abs(counts), volts)
        if {"x_m", "y_m"} <= sources.keys():
            x, y = (log.numbers(sources[axis].column) for axis in ("x_m", "y_m"))
            return are_per_row(np.abs(counts), np.hypot(np.diff(x, prepend=x[:1]), np.diff(y, prepend=y[:1])))
    except InputError:  # wrong cells are reported together, when the rows are read
        pass
    return False


def _is_clockwise(header: HeaderName) -> bool:
    """Return whether a name states that a heading is counted clockwise, as `yaw_cw` and not `yaw_counter_clockwise`."""
    senses = SENSE & set(header.words)
    return bool(senses) and senses <= CLOCKWISE


def _of_both_wheels(units: Mapping[str, str], columns: Mapping[str, str]) -> Mapping[str, str]:
    """Return the stated units, and that of the voltage of one wheel for the other one, if its name has no unit."""
    others = {
        other: units[name]
        for name, other in OTHER_WHEEL.items()
        if name in units and other in columns and not taken_apart(columns[other]).unit
    }
    return {**others, **units}


def _duty_factor(log: LogFile, kind: LogKind, name: str, known: Known) -> tuple[float, str]:
    """Return the voltage for a value of 1, and the reason, by the largest value of all columns of duty cycles.

    Raises:
        UnknownUnitError: Whole numbers below 100 may be per cent, or steps of 8 bit of a motor that was never full on.
    """
    largest, is_whole = 0.0, True
    for column in (column for column in known.columns.values() if DUTY & {*taken_apart(column).words}):
        with suppress(InputError):
            duty = log.numbers(column)
            largest = max(largest, float(np.nanmax(np.abs(duty), initial=0.0)))
            is_whole = is_whole and bool(np.all(duty[np.isfinite(duty)] % 1.0 == 0.0))
    if is_whole and SMALLEST_V < largest < 100.0:
        shown, readings = f"the values up to {largest:g}", readings_of_duty(largest, known.supply_V)
        raise asked(log, kind, name, known.columns[name], shown=shown, readings=readings)
    full = next((full for full in FULL_DUTIES if largest <= full), largest)
    reason = f"taken for a duty cycle of which {full:g} is full, since the values are up to {largest:.4g}"
    doubt = f"; if the values are millivolts, write unit: mV without a factor in {MAPPING}"
    text = f"{reason}, times {_supply_text(kind, known.supply_V)}{doubt if largest > MIN_MILLIVOLTS else ''}"
    text += "" if known.supply_V else battery_advice(log, kind)
    return (known.supply_V or USUAL_SUPPLY_V) / full, text


def _supply_text(kind: LogKind, supply_V: float | None) -> str:
    if supply_V:
        return f"{supply_V:g} V"
    return f"a supply of {USUAL_SUPPLY_V:g} V, which is not known: give it {kind.supply_option}"
