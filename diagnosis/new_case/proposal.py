"""Proposal of a mapping for a log: kind and columns from the names, units from the names or from the values."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from diagnosis.importers.drive_log import ROW_S
from diagnosis.measured.case_format import NO_TARGET_FROM_M, RANGES
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.scale import beyond_scale, likely_unit
from diagnosis.measured.screening import usual
from diagnosis.new_case.counts import are_per_row
from diagnosis.new_case.log_file import LogFile
from diagnosis.new_case.mapping import MAPPING, LogMapping, Source
from diagnosis.new_case.quantities import COUNTS, DUTY, NEEDED, PER_ROW, matched, of_wheels, our_columns, sides_of
from diagnosis.new_case.units import factor_to, taken_apart
from symolo.core.arrays import Array
from symolo.core.errors import InputError

STEADY_FROM_S = 0.25
"""Time between two rows from which a log of a motor has one steady state in each row."""
FASTEST_TURN_RAD_S = 12.0
"""Speed at which no small robot turns for long; a heading that changes faster is in degrees."""
LARGEST_ROOM_M = 20.0
FULL_DUTIES = (1.0, 100.0, 255.0, 1023.0, 4095.0)
"""Values of a full duty cycle in logs: share, per cent, 8, 10 and 12 bit."""
USUAL_SUPPLY_V = 7.4
SMALLEST_MM = 600.0
"""Extent from which a length that is no metre is in millimetres rather than in centimetres."""


@dataclass(frozen=True)
class Proposal:
    mapping: LogMapping
    warnings: tuple[str, ...]
    """Guesses that the user has to check, in one sentence each."""


def propose(log: LogFile, kind: CaseKind | None = None, supply_V: float | None = None) -> Proposal:
    """Return a mapping for a log.

    Args:
        log: The log.
        kind: Kind of the case; recognised from the columns by default.
        supply_V: Voltage of a duty cycle of 1, if it is known.

    Raises:
        InputError: The columns of no kind, or not those of this one, are in the log.
    """
    if kind in {None, CaseKind.DRIVE_LOG}:
        _check_wheels(log)
    kind = kind or _kind(log)
    recognised = matched(kind, list(log.columns))
    if not _suffices(kind, recognised):
        raise _missing(log, kind, recognised)
    ours = our_columns(kind)
    sources: dict[str, Source] = {}
    warnings = []
    for name, column in recognised.items():
        unit = taken_apart(column).unit if column != name else ""
        if DUTY & set(taken_apart(column).words) and not unit:
            factor, reason = _of_duty(
                log, [other for other in recognised.values() if DUTY & set(taken_apart(other).words)]
            )
            sources[name] = Source(column=column, factor=factor * (supply_V or USUAL_SUPPLY_V))
            cure = "which is not known: give it with --set supply_voltage_V=NUMBER"
            supply = f"{supply_V:g} V" if supply_V else f"a supply of {USUAL_SUPPLY_V:g} V, {cure}"
            warnings.append(f"{column} ({name}): {reason}, times {supply}")
            continue
        if name in ours and not unit and column != name and ours[name].unit:
            with suppress(InputError):  # wrong cells are reported together, when the rows are read
                unit, reason = _guessed(name, ours[name].unit, log.numbers(column), log, _step_s(log, sources))
                warnings += [f"{column} ({name}): the name has no unit; {reason}"] if reason else []
        sources[name] = Source(column=column, unit="" if name in ours and unit == ours[name].unit else unit)
    for name in [name for name in COUNTS if name in sources and _are_per_row(log, name, sources)]:
        column = sources[name].column
        sources[name] = sources[name].model_copy(update={"per_row": True})
        is_named = PER_ROW & set(taken_apart(column).words)
        reason = "by its name" if is_named else "since it follows the speed itself"
        warnings.append(f"{column} ({name}): taken for the ticks since the row before, {reason}")
    if "tof_front_m" in sources and not sides_of(column := sources["tof_front_m"].column) and column != "tof_front_m":
        warnings.append(f"{column} (tof_front_m): taken for the sensor in front; else rename it in {MAPPING}")
    return Proposal(LogMapping.model_validate({"kind": kind.value, "columns": sources}), tuple(warnings))


def _check_wheels(log: LogFile) -> None:
    """Refuse a log of a robot with more than two driven wheels.

    Raises:
        InputError: More than two columns are counts of encoders.
    """
    wheels = of_wheels(list(log.columns))
    if len(wheels) > 2:
        raise InputError(
            f"counts of {len(wheels)} wheels: {', '.join(wheels)}",
            where=f"{log.path}: row 1",
            allowed="one left and one right wheel on a common axle, which is all that the simulator can drive",
            cure="a robot with three omnidirectional wheels cannot be compared; if two of the wheels are such a pair, "
            f"or each side has several wheels on one motor, write a {MAPPING} (docs/diagnosis.md) with one column for "
            "each side, and name it with --mapping",
        )


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


def _of_duty(log: LogFile, columns: Sequence[str]) -> tuple[float, str]:
    """Return the share of the supply for a value of 1, and the reason, by the largest value of all such columns."""
    largest = 0.0
    for column in columns:
        with suppress(InputError):
            largest = max(largest, float(np.nanmax(np.abs(log.numbers(column)), initial=0.0)))
    full = next((full for full in FULL_DUTIES if largest <= full), largest)
    return 1.0 / full, f"taken for a duty cycle of which {full:g} is full, since the values are up to {largest:.4g}"


def _step_s(log: LogFile, sources: Mapping[str, Source]) -> float:
    """Return the usual time between two rows, by the column of times if there is one."""
    if "t_s" not in sources:
        return ROW_S
    times = sources["t_s"]
    return factor_to("s", times.unit, "t_s") * _step(log.numbers(times.column))


def _kind(log: LogFile) -> CaseKind:
    """Return the kind whose needs the columns meet, and most of whose quantities they hold."""
    columns_of_kind = {kind: matched(kind, list(log.columns)) for kind in NEEDED}
    fitting = [kind for kind in NEEDED if _suffices(kind, columns_of_kind[kind])]
    closest = max(NEEDED, key=lambda kind: len(columns_of_kind[kind]))
    if not fitting and len(columns_of_kind[closest]) > 1:
        raise _missing(log, closest, columns_of_kind[closest])
    if not fitting:
        raise InputError(
            "cannot recognise what was logged from the names of the columns",
            where=f"{log.path}: row 1",
            got=list(log.columns),
            allowed="; ".join(f"for {kind}: {' '.join(sorted(NEEDED[kind][0]))}" for kind in NEEDED),
            cure=f"rename the columns, or write a {MAPPING} (docs/diagnosis.md) and name it with --mapping",
        )
    best = max(fitting, key=lambda kind: len(columns_of_kind[kind]))
    if best in {CaseKind.MOTOR_STEP, CaseKind.MOTOR_STEADY}:
        return (
            CaseKind.MOTOR_STEP
            if _is_fast(log, columns_of_kind[CaseKind.MOTOR_STEP].get("t_s", ""))
            else CaseKind.MOTOR_STEADY
        )
    return best


def _suffices(kind: CaseKind, recognised: Mapping[str, str]) -> bool:
    """Return whether a log has one of the sets of quantities that a kind needs."""
    return any(needed <= set(recognised) for needed in NEEDED[kind])


def _missing(log: LogFile, kind: CaseKind, recognised: Mapping[str, str]) -> InputError:
    """Return an error that names what is missing of the set of quantities that is nearest to complete.

    A range is named only if it alone is missing, and then beside what else would do.
    """
    several = [needed - set(recognised) for needed in NEEDED[kind]]
    without_range = [missing for missing in several if not missing & RANGES] or several
    nearest = dict.fromkeys(min(sets, key=len) for sets in (without_range, several))
    missing = " or ".join(" ".join(sorted(each)) for each in nearest)
    unused = [name for name in log.columns if name not in recognised.values()]
    cure = f"rename them, or write a {MAPPING} (docs/diagnosis.md) and name it with --mapping"
    return InputError(
        f"no column was recognised as {missing}, which a case of the kind {kind} needs",
        where=f"{log.path}: row 1",
        cure=f"not recognised: {', '.join(unused) or 'none'}; {cure}",
    )


def _is_fast(log: LogFile, column: str) -> bool:
    """Return whether the rows of a motor's log are samples against time, rather than steady states."""
    if not column:
        return False
    step = _step(log.numbers(column))
    unit = taken_apart(column).unit or _guessed_time(log.numbers(column), log)[0]
    return factor_to("s", unit, column) * step < STEADY_FROM_S


def _step(times: Array) -> float:
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0.0]
    return usual(steps) if len(steps) else 0.0


def _guessed(name: str, ours: str, values: Array, log: LogFile, step_s: float) -> tuple[str, str]:
    """Return the unit in which the values seem to be, and a sentence that says why; no sentence if it is certain."""
    known = values[np.isfinite(values)]
    if not len(known):
        return "", ""
    largest = float(np.abs(known).max())
    if ours == "s":
        return _guessed_time(known, log)
    if name in RANGES:
        below = known[known < NO_TARGET_FROM_M * 1e3 - 1.0]
        largest = float(below.max()) if len(below) else largest
    if ours == "m":
        return _guessed_length(known, largest, is_range=name in {*RANGES, "distance_m"})
    if ours == "rad":
        return _guessed_angle(known, step_s)
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


def _guessed_angle(known: Array, step_s: float) -> tuple[str, str]:
    turned = np.abs(np.diff(known))
    largest = float(np.abs(known).max())
    wraps = turned[turned > np.pi]
    is_wrapped_rad = len(wraps) > 0 and float(np.median(np.abs(wraps - 2.0 * np.pi))) < 1.0
    is_fast = len(turned) > 0 and float(np.quantile(turned, 0.9)) > FASTEST_TURN_RAD_S * max(step_s, 1e-3)
    if not is_wrapped_rad and largest > 2.0 * np.pi + 0.5 and (is_fast or bool(np.any(turned > 300.0))):
        return "degrees", f"taken for degrees, since the values are up to {largest:.4g}"
    return "", f"taken for radians, since the values are up to {largest:.3g}"


def unit_faults(mapping: LogMapping, values: dict[str, Array], log: LogFile) -> Sequence[InputError]:
    """Return an error for each quantity that no robot can have in the unit that the mapping states."""
    faults = []
    for name, column in our_columns(mapping.case_kind).items():
        typical = beyond_scale(values[name], column.reach) if name in values else None
        if typical is None:
            continue
        source = mapping.columns[name]
        factor = likely_unit(typical, column.reach, column.unit) or "check its unit"
        faults.append(
            InputError(
                f"column {source.column or source.constant}: as {source.unit or column.unit} it gives {name} around "
                f"{typical:.4g} {column.unit}",
                where=str(log.path),
                allowed=column.reach.words(column.unit),
                cure=f"{factor}; correct its unit in {MAPPING} and give that with --mapping",
            )
        )
    return faults
