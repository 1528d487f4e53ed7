"""Proposal of a mapping for a log: columns from the names, units from the names or from the values."""

import shlex
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from logs.counts import are_per_row
from logs.drive import COUNT_WORDS, COUNTED, PER_ROW
from logs.heading_unit import guessed_heading_unit
from logs.log_file import LogFile
from logs.mapping import MAPPING, LogMapping, Source
from logs.plausible_units import OTHER_UNITS, beyond_scale, likely_unit
from logs.quantity import CLOCKWISE, DUTY, SENSE, LogKind, QuantityScale
from logs.times import usual_step
from logs.units import PERCENT, HeaderName, factor_to, fits, taken_apart
from symolo.core.arrays import Array
from symolo.core.errors import InputError

NO_TARGET_FROM = 8.19e3
"""Smallest of the codes of range sensors for "no target", which are 8190 and 8191 mm."""
MAX_INCIDENCE_RAD = 0.5 * np.pi + 0.1
"""Largest angle of incidence, with a margin."""
LARGEST_ROOM_M = 20.0
FULL_DUTIES = (1.0, 100.0, 255.0, 1023.0, 4095.0)
"""Values of a full duty cycle in logs: share, per cent, 8, 10 and 12 bit."""
MIN_MILLIVOLTS = 1023.0
"""Largest value of a column from which on it may be in millivolts rather than a duty cycle of 10 bit."""
USUAL_SUPPLY_V = 7.4
SMALLEST_MM = 600.0
"""Extent from which a length that is no metre is in millimetres rather than in centimetres."""
DEFAULT_STEP_S = 0.05
SAME = 1e-3
"""Relative difference up to which two factors are those of one unit."""
GEAR_ADVICE = (
    "if it is the speed of the motor's shaft, divide it by the gear ratio, such as factor: 0.00833 for a ratio of 120"
)


@dataclass(frozen=True)
class Proposal:
    mapping: LogMapping
    warnings: tuple[str, ...]
    """Guesses that the user has to check, in one sentence each."""


def propose_as(
    log: LogFile,
    kind: LogKind,
    supply_V: float | None = None,
    left_open: Collection[str] = (),
    chosen: Mapping[str, str] = MappingProxyType({}),
) -> Proposal:
    """Return a mapping for a log of a kind.

    Args:
        log: The log.
        kind: Kind of the log.
        supply_V: Voltage of a duty cycle of 1, if it is known.
        left_open: Quantities whose unit the caller guesses if no name states it.
        chosen: Columns that the user chose, by quantity.

    Raises:
        InputError: The log lacks columns of this kind.
    """
    recognised = kind.matched(list(log.columns), chosen)
    if not kind.suffices(recognised):
        raise missing(log, kind, recognised)
    sources: dict[str, Source] = {}
    warnings = []
    for name, column in recognised.items():
        unit, ours = taken_apart(column).unit if column != name else "", kind.unit_of(name)
        if name not in chosen and kind.is_by_unit(name, column):
            warnings.append(f"{column} ({name}): taken for it by its unit alone; else correct it in {MAPPING}")
        if unit == PERCENT or (DUTY & set(taken_apart(column).words) and not unit):
            duties = [other for other in recognised.values() if DUTY & set(taken_apart(other).words)]
            factor, reason = _of_percent(kind, supply_V) if unit else _of_duty(kind, log, duties, supply_V)
            sources[name] = Source(column=column, unit=unit, factor=factor)
            warnings.append(f"{column} ({name}): {reason}")
            continue
        if ours and not unit and column != name and name not in left_open:
            with suppress(InputError):  # wrong cells are reported together, when the rows are read
                if name == "theta_rad":
                    unit, reason = _guessed_heading(kind, sources, log, log.numbers(column))
                else:
                    unit, reason = _guessed(kind, name, log.numbers(column), log)
                warnings += [f"{column} ({name}): the name has no unit; {reason}"] if reason else []
        if unit == "degrees" and column.lower().rstrip(" )]").endswith("grad"):
            warnings.append(f"{column} ({name}): taken for degrees; if a turn has 400, write unit: gon in {MAPPING}")
        sense = -1.0 if name == "theta_rad" and _is_clockwise(taken_apart(column)) else 1.0
        sources[name] = Source(column=column, unit="" if unit == ours else unit, factor=sense)
    for name in [name for name in COUNTED if name in sources and _are_per_row(log, name, sources)]:
        column = sources[name].column
        sources[name] = sources[name].model_copy(update={"per_row": True})
        is_named = PER_ROW & set(taken_apart(column).words)
        reason = "by its name" if is_named else "because it rises and falls with the speed"
        warnings.append(f"{column} ({name}): taken for the ticks since the row before, {reason}")
    return Proposal(LogMapping.model_validate({"kind": kind.name, "columns": sources}), tuple(warnings))


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


def time_step_s(log: LogFile, column: str) -> float:
    """Return the usual time [s] between two rows, by a column whose unit may be a guess."""
    times = log.times(column)
    unit = taken_apart(column).unit or _guessed_time(times, log)[0]
    return factor_to("s", unit, column) * _step(times)


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
            return are_per_row(counts, log.numbers(voltage.column))
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


def _of_duty(kind: LogKind, log: LogFile, columns: Sequence[str], supply_V: float | None) -> tuple[float, str]:
    """Return the voltage for a value of 1, and the reason, by the largest value of all columns of duty cycles."""
    largest = 0.0
    for column in columns:
        with suppress(InputError):
            largest = max(largest, float(np.nanmax(np.abs(log.numbers(column)), initial=0.0)))
    full = next((full for full in FULL_DUTIES if largest <= full), largest)
    reason = f"taken for a duty cycle of which {full:g} is full, since the values are up to {largest:.4g}"
    doubt = f"; if the values are millivolts, write unit: mV without a factor in {MAPPING}"
    text = f"{reason}, times {_supply_text(kind, supply_V)}{doubt if largest > MIN_MILLIVOLTS else ''}"
    return (supply_V or USUAL_SUPPLY_V) / full, text


def _of_percent(kind: LogKind, supply_V: float | None) -> tuple[float, str]:
    """Return the voltage for 100 %, and the reason."""
    return supply_V or USUAL_SUPPLY_V, f"a duty cycle in percent, times {_supply_text(kind, supply_V)}"


def _supply_text(kind: LogKind, supply_V: float | None) -> str:
    if supply_V:
        return f"{supply_V:g} V"
    return f"a supply of {USUAL_SUPPLY_V:g} V, which is not known: give it {kind.supply_option}"


def _step(times: Array) -> float:
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0.0]
    return usual_step(steps) if len(steps) else 0.0


def _guessed(kind: LogKind, name: str, values: Array, log: LogFile) -> tuple[str, str]:
    """Return the unit in which the values seem to be, and a sentence that says why; no sentence if it is certain."""
    known, ours = values[np.isfinite(values)], kind.unit_of(name)
    if not len(known):
        return "", ""
    largest = float(np.abs(known).max())
    if ours == "s":
        return _guessed_time(known, log)
    if name in kind.ranges:
        below = known[known < NO_TARGET_FROM - 1.0]
        largest = float(below.max()) if len(below) else largest
    if ours == "m":
        return _guessed_length(known, largest, is_range=name in kind.ranges)
    if ours == "rad":
        return _guessed_angle(largest)
    if ours == "V" and 0.0 < largest <= 1.0:
        return "", f"taken for V, since the values are up to {largest:.4g}; a duty cycle needs a factor"
    if ours in {"V", "A"} and largest > 60.0:
        return f"m{ours}", f"taken for m{ours}, since the values are up to {largest:.4g}; a duty cycle needs a factor"
    if ours == "rad/s":
        unit = "rpm" if largest > 60.0 else ""
        return unit, f"taken for {unit or ours}, since the values are up to {largest:.4g}"
    return "", ""


def _guessed_length(known: Array, largest: float, *, is_range: bool) -> tuple[str, str]:
    """Return the unit of places in a room or of ranges; range sensors of small robots report millimetres."""
    extent = largest if is_range else float(np.ptp(known))
    if max(extent, largest) <= LARGEST_ROOM_M:
        return "", f"taken for metres, since the values are up to {largest:.3g}"
    unit, other = ("mm", "cm") if is_range or extent >= SMALLEST_MM else ("cm", "mm")
    reason = f"taken for {unit}, since the values are up to {largest:.4g}"
    return unit, f"{reason}; if they are {other}, correct it in {MAPPING}"


def _guessed_time(known: Array, log: LogFile) -> tuple[str, str]:
    step = _step(known)
    is_whole = bool(np.all(known == np.rint(known)))
    if not is_whole or (step < 100.0 and log.rows < 100):
        return "", ""
    unit = "ms" if step < 1e3 else "us" if step < 1e6 else "ns"
    return unit, f"taken for {unit}, since rows are {step:.6g} apart"


def _guessed_heading(kind: LogKind, sources: Mapping[str, Source], log: LogFile, heading: Array) -> tuple[str, str]:
    """Return the unit of a heading (N,) by the motion of the columns that are mapped already, and a sentence."""
    ours = {
        name: factor_to(kind.unit_of(name), sources[name].unit, name) * log.numbers(sources[name].column)
        for name in ("t_s", "x_m", "y_m")
        if name in sources
    }
    place_m = np.column_stack((ours["x_m"], ours["y_m"])) if {"x_m", "y_m"} <= ours.keys() else None
    t_s = ours.get("t_s", DEFAULT_STEP_S * np.arange(log.rows))
    unit, reason = guessed_heading_unit(t_s, place_m, heading)
    return unit, f"taken for {unit or 'radians'}, {reason}" if reason else ""


def _guessed_angle(largest: float) -> tuple[str, str]:
    """Return the unit of an angle of incidence, which is within a right angle."""
    unit = "degrees" if largest > MAX_INCIDENCE_RAD else ""
    return unit, f"taken for {unit or 'radians'}, since the values are up to {largest:.4g}"
