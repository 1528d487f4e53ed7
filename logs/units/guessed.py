"""Units of columns whose names state none, from their values; a unit that the values do not show is asked for."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from logs.columns.quantity import SUPPLY, LogKind, words
from logs.log_file import LogFile
from logs.mapping import MAPPING, Source
from logs.times import usual_step
from logs.units.heading import guessed_heading_unit
from logs.units.names import PERCENT, factor_to, per_unit, taken_apart, unit_of
from symolo.core.arrays import Array
from symolo.core.errors import InputError

NO_TARGET_FROM = 8.19e3
"""Smallest of the codes of range sensors for "no target", which are 8190 and 8191 mm."""
MAX_INCIDENCE_RAD = 0.5 * np.pi + 0.1
"""Largest angle of incidence, with a margin."""
LARGEST_ROOM_M = 20.0
SMALLEST_MM = 600.0
"""Extent from which a length that is no metre is in millimetres rather than in centimetres."""
DEFAULT_STEP_S = 0.05
LONGEST_LOG_S = 4.0 * 3600.0
"""Longest time over which a small robot or a bench is logged."""
BEGIN_S = (1e9, 3e9)
"""Range of the times since 1970, from 2001 to 2065."""
USUAL_SUPPLY_V = 7.4
BY_NAME_V = words("voltage volt volts vm umot spannung motorspannung tension")
"""Words of a voltage; a motor, a command or u may as well be a duty cycle."""
LARGEST_SURE_V, LARGEST_V = 15.0, 60.0
"""Largest value that is surely in volts, whatever the name, and largest voltage of a small robot."""
SMALLEST_V = 1.0
"""Largest value from which on a voltage is no duty cycle as a share of one."""
MILLIVOLTS_FROM, NAMED_MILLIVOLTS_FROM = 4095.0, 1e3
"""Largest value from which on a voltage is surely in millivolts, and the same of a column that is called a voltage."""
FULL_DUTIES = (1.0, 100.0, 255.0, 1023.0, 4095.0)
"""Values of a full duty cycle in logs: share, per cent, 8, 10 and 12 bit."""
LARGEST_SURE_A, LARGEST_A = 10.0, 60.0
"""Largest current that is surely in amperes, and largest current of a small robot."""
MAX_RAD_S = 60.0
"""Largest speed from which on a motor's speed is in turns per minute."""
OTHER_WHEEL = {"u_left_V": "u_right_V", "u_right_V": "u_left_V"}
"""Voltages that a log has in the same unit."""
DUTY_UNIT = "duty_"
"""Beginning of the unit of a duty cycle, before its full value."""


@dataclass(frozen=True)
class Known:
    """What is known of a log while its units are guessed."""

    sources: Mapping[str, Source]
    """Sources of the quantities that are mapped already."""
    columns: Mapping[str, str]
    """Columns of all quantities by their names, mapped already or not."""
    supply_V: float | None
    """Voltage of a full duty cycle; None if it is not known."""


class UnknownUnitError(InputError):
    """Neither the name of a column nor its values show its unit."""


@dataclass(frozen=True)
class Reading:
    """A unit that a column may have, and what it would mean."""

    unit: str
    meaning: str


def asked(
    log: LogFile, kind: LogKind, name: str, column: str, *, shown: str, readings: Sequence[Reading]
) -> UnknownUnitError:
    """Return the error that asks for the unit of a column.

    Args:
        log: The log.
        kind: Its kind.
        name: Quantity of the column.
        column: The column.
        shown: What the values are, such as `the values up to 254`.
        readings: Units that are possible, the likeliest first.
    """
    texts = "; ".join(f"{reading.unit}: {reading.meaning}" for reading in readings)
    option = (
        f"such as {kind.unit_option} {name}={readings[0].unit}"
        if kind.unit_option
        else f"in a file for {kind.mapping_option}"
    )
    is_duty = any(reading.unit.startswith(DUTY_UNIT) for reading in readings)
    battery = battery_advice(log, kind) if is_duty else ""
    what = f"column {column}: its unit is not known, and {shown} do not show it"
    return UnknownUnitError(what, where=log.header_where, cure=f"state it, {option}; {texts}{battery}")


def battery_advice(log: LogFile, kind: LogKind) -> str:
    """Return the end of a sentence on how duty cycles get the logged voltage of the battery; empty if it was not."""
    batteries = [column for column in log.columns if SUPPLY & {*taken_apart(column).words}]
    return f"; a mapping may multiply a duty cycle by {batteries[0]} ({kind.page})" if batteries else ""


def guessed(log: LogFile, kind: LogKind, name: str, column: str, known: Known) -> tuple[str, str]:
    """Return the unit in which the values of a column seem to be, and a sentence that says why; none if it is certain.

    Args:
        log: The log.
        kind: Its kind.
        name: Quantity of the column.
        column: The column.
        known: What is known of the log.

    Raises:
        UnknownUnitError: Several units are as likely.
        InputError: A cell is no number.
    """
    values, ours = log.numbers(column), kind.unit_of(name)
    finite = values[np.isfinite(values)]
    if not len(finite) or (ours and unit_of(column) == ours):
        return "", ""
    largest = float(np.abs(finite).max())
    if name == "theta_rad":
        return _guessed_heading(kind, known.sources, log, values)
    if ours == "s":
        return _guessed_time(kind, name, column, finite, log)
    if ours == "m":
        if name in kind.ranges and len(below := finite[finite < NO_TARGET_FROM - 1.0]):
            largest = float(below.max())
        return _guessed_length(finite, largest, is_range=name in kind.ranges)
    if ours in {"V", "A"}:
        is_voltage = ours == "V"
        finite = np.concatenate([finite, _of_other_wheel(log, name, known)])
        largest = float(np.abs(finite).max())
        readings = readings_of_voltage(column, finite, known.supply_V) if is_voltage else readings_of_current(largest)
        if len(readings) > 1:
            raise asked(log, kind, name, column, shown=f"the values up to {largest:.4g}", readings=readings)
        unit = "" if readings[0].unit == ours else readings[0].unit
        return unit, f"taken for {unit}, since the values are up to {largest:.4g}" if unit else ""
    return _guessed_angle(kind, name, largest)


def _of_other_wheel(log: LogFile, name: str, known: Known) -> Array:
    """Return the values of the voltage of the other wheel if its name has no unit either, since both have the same."""
    column = known.columns.get(OTHER_WHEEL.get(name, ""), "")
    if not column or taken_apart(column).unit:
        return np.empty(0)
    values = log.numbers(column)
    return values[np.isfinite(values)]


def _guessed_angle(kind: LogKind, name: str, largest: float) -> tuple[str, str]:
    """Return the unit of an angle of incidence, which is within a right angle, or of the speed of a motor."""
    ours = kind.unit_of(name)
    if ours == "rad":
        unit = "degrees" if largest > MAX_INCIDENCE_RAD else ""
        return unit, f"taken for {unit or 'radians'}, since the values are up to {largest:.4g}"
    if ours != "rad/s":
        return "", ""
    unit, other = ("rpm", "rad/s") if largest > MAX_RAD_S else ("", "rpm")
    doubt = f"if they are in {other}, state that with {kind.unit_option} {name}={other}"
    return unit, f"taken for {unit or ours}, since the values are up to {largest:.4g}; {doubt}"


def readings_of_voltage(column: str, known: Array, supply_V: float | None) -> list[Reading]:
    """Return the units that a voltage (N,) without a unit in its name may have, the likeliest first; one is sure."""
    largest, is_whole = float(np.abs(known).max()), bool(np.all(known == np.rint(known)))
    is_named = bool(BY_NAME_V & {*taken_apart(column).words})
    if largest == 0.0 or SMALLEST_V < largest <= (LARGEST_V if is_named else LARGEST_SURE_V):
        return [Reading("V", f"up to {largest:.4g} V")]
    if largest > (NAMED_MILLIVOLTS_FROM if is_named else MILLIVOLTS_FROM):
        return [Reading("mV", f"up to {1e-3 * largest:.4g} V")]
    readings = readings_of_duty(largest, supply_V) if is_whole or largest <= 255.0 else []
    readings += [Reading("V", f"up to {largest:.4g} V")] if largest <= LARGEST_V else []
    return readings + ([Reading("mV", f"up to {1e-3 * largest:.4g} V")] if largest > LARGEST_V else [])


def readings_of_duty(largest: float, supply_V: float | None) -> list[Reading]:
    """Return the units that duty cycles up to a value may have, the likeliest first."""
    fulls = [full for full in FULL_DUTIES if largest <= full]
    # Up to 100, a duty cycle in percent may as well be one of 8 bit that was never full.
    fulls = fulls[: 2 if SMALLEST_V < largest <= 100.0 else 1]
    return [Reading(duty_unit(full), _duty_meaning(full, largest, supply_V)) for full in fulls]


def full_duty(unit: str) -> float | None:
    """Return the value of a full duty cycle in a unit such as `duty_255` or `percent`; None in another unit."""
    if unit == PERCENT:
        return 100.0
    text = unit.removeprefix(DUTY_UNIT)
    return float(text) if text != unit and text.isdecimal() and float(text) > 0.0 else None


def duty_unit(full: float) -> str:
    """Return the unit of a duty cycle by its full value."""
    return PERCENT if full == 100.0 else f"{DUTY_UNIT}{full:g}"


def _duty_meaning(full: float, largest: float, supply_V: float | None) -> str:
    supply = f"the supply's {supply_V:g} V" if supply_V else f"a supply of {USUAL_SUPPLY_V:g} V"
    return (
        f"a duty cycle of which {full:g} is full, so up to {largest / full * (supply_V or USUAL_SUPPLY_V):.4g} V of "
        f"{supply}"
    )


def readings_of_current(largest: float) -> list[Reading]:
    """Return the units that a current without a unit in its name may have, by its largest value; one is sure."""
    in_A, in_mA = Reading("A", f"up to {largest:.4g} A"), Reading("mA", f"up to {1e-3 * largest:.4g} A")
    if largest <= LARGEST_SURE_A:
        return [in_A]
    return [in_mA] if largest > LARGEST_A else [in_mA, in_A]


def time_units(times: Array, step_s: tuple[float, float]) -> list[str]:
    """Return the units that times (N,) without a unit in their name may have; one if it is sure.

    Args:
        times: Times, NaN where there is none.
        step_s: Shortest and longest usual time between two rows of such a log.
    """
    known = times[np.isfinite(times)]
    step = usual_step_of(known)
    if step == 0.0 or (step < 1.0 and np.any(known != np.rint(known))):
        return ["s"]
    shortest_s, longest_s = step_s
    units = {"s": 1.0, **{unit: per for unit, per in per_unit("s").items() if unit in {"ms", "us", "ns"}}}
    fits = {
        unit: per
        for unit, per in units.items()
        if shortest_s <= step / per <= longest_s and step * len(known) / per <= LONGEST_LOG_S
    }
    since_1970 = [unit for unit, per in fits.items() if BEGIN_S[0] * per <= known[0] < BEGIN_S[1] * per]
    usual = ["ms" if step < 1e3 else "us" if step < 1e6 else "ns"]
    return since_1970[:1] or list(fits) or usual


def usual_step_of(times: Array) -> float:
    """Return the usual step of times (N,), NaN where there is none; 0 if they never go on."""
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0.0]
    return usual_step(steps) if len(steps) else 0.0


def _guessed_time(kind: LogKind, name: str, column: str, known: Array, log: LogFile) -> tuple[str, str]:
    if column in log.clocks:
        return "", ""
    units, step = time_units(known, kind.step_s), usual_step_of(known)
    if len(units) > 1:
        readings = [Reading(unit, f"rows are {factor_to('s', unit, column) * step:.4g} s apart") for unit in units]
        raise asked(log, kind, name, column, shown=f"rows that are {step:.6g} apart", readings=readings)
    if units[0] == "s" and step < 1.0:
        return "", ""
    return "" if units[0] == "s" else units[0], f"taken for {units[0]}, since rows are {step:.6g} apart"


def _guessed_length(known: Array, largest: float, *, is_range: bool) -> tuple[str, str]:
    """Return the unit of places in a room or of ranges; range sensors of small robots report millimetres."""
    extent = largest if is_range else float(np.ptp(known))
    if max(extent, largest) <= LARGEST_ROOM_M:
        return "", f"taken for metres, since the values are up to {largest:.3g}"
    unit, other = ("mm", "cm") if is_range or extent >= SMALLEST_MM else ("cm", "mm")
    reason = f"taken for {unit}, since the values are up to {largest:.4g}"
    return unit, f"{reason}; if they are {other}, correct it in {MAPPING}"


def _guessed_heading(kind: LogKind, sources: Mapping[str, Source], log: LogFile, heading: Array) -> tuple[str, str]:
    """Return the unit of a heading (N,) by the motion of the columns that are mapped already, and a sentence."""
    ours = {
        name: factor_to(kind.unit_of(name), sources[name].unit, name) * sources[name].numbers(log)
        for name in ("t_s", "x_m", "y_m")
        if name in sources
    }
    place_m = np.column_stack((ours["x_m"], ours["y_m"])) if {"x_m", "y_m"} <= ours.keys() else None
    t_s = ours.get("t_s", DEFAULT_STEP_S * np.arange(log.rows))
    unit, reason = guessed_heading_unit(t_s, place_m, heading)
    return unit, f"taken for {unit or 'radians'}, {reason}" if reason else ""
