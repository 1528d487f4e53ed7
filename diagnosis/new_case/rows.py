"""The rows of a log as a measurement: our columns and units, trials, a regular rate, and rows to hold out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.case_files.case_format import (
    CAMERA_CHANNELS,
    LONG_AFTER_S,
    RANGES,
    WHEEL_VOLTAGES,
    channel_columns,
)
from diagnosis.measured.channel import Channel, Label, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.measured.zero_order_hold import held_means
from diagnosis.new_case.held_rows import held_by_other_rows, held_otherwise, left_out_notes
from diagnosis.new_case.input_reach import input_faults, missing_inputs
from diagnosis.new_case.quantities import KINDS
from diagnosis.new_case.sample_times import are_even, even_times, row_of_drive_s
from diagnosis.new_case.sampling_note import has_times, in_words, is_input
from diagnosis.new_case.trial_rows import IN_TIME, rows_of_trials
from logs.columns.drive import COUNTED
from logs.columns.proposal import unit_faults
from logs.counts import running_counts
from logs.log_file import LogFile
from logs.mapping import MAPPING, LogMapping, Source, missing_note
from logs.times import usual_step
from logs.units.names import factor_to, unit_of
from logs.units.possible_motion import check_motion, larger_time_unit
from logs.units.wrapped_angles import whole_turn
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError, together
from symolo.core.tables.time_series import TimeSeries

SLOWEST_S = 0.1
"""Longest usual step of a drive: windows of half a second need a few rows."""
IRREGULAR: Mapping[CaseKind, float] = {CaseKind.DRIVE_LOG: 0.02, CaseKind.MOTOR_STEP: 0.2}
"""Share of a step by which most steps may differ from the usual one without a new sampling. In a drive, speeds are
changes of counts from row to row: 2 % of the step are 2 % of the speed.
"""
AT_REST = 0.25
"""Largest speed in the first row, as a share of that in the second, of a motor that is still at rest in the first."""
TOO_LARGE = 1e100
"""Size of a number that is none of any quantity; squares of smaller ones do not overflow."""
BRIDGED_STEPS = 3.0
"""Longest gap, in usual steps, across which counts and poses are interpolated."""
DECIMALS = 9
"""Decimals of a converted number, whose last digits are rounding errors of the factor."""
HELD_OUT_EACH = 4
"""Every 4th row of a bench and every 4th trial is held out; of fewer than 4 trials, the last quarter of each."""
MIN_HELD_MOTION = 0.05
"""Share of the motion of a trial that its last quarter needs, if it is to say anything about the robot."""
_MOVES = ("enc_left_ticks", "enc_right_ticks", "omega_rad_s")
"""Columns by which a trial moves: counts, and the speed of a motor, which changes while the motor starts and stops."""


@dataclass(frozen=True)
class _Rows:
    """Rows of one trial."""

    t_s: Array
    """(N,), increasing times of the rows [s]."""
    values: Mapping[str, Array]
    """(N,) of each column."""
    words: tuple[str, ...] = ()
    """(N,), materials; empty if there are none."""
    held_inputs: tuple[TimeSeries, ...] = ()
    """Voltages that change between the rows."""


def measurement_of(log: LogFile, mapping: LogMapping, name: str) -> Measurement:
    """Return a log as a measurement without nominal parameters; its notes name everything that was changed.

    Raises:
        InputError: A cell is no number, a quantity is in another unit, or the rows cannot be used; all are reported.
    """
    kind, notes = CaseKind(mapping.kind), list(log.notes)
    values = _values(log, mapping, notes)
    material = mapping.columns.get("material")
    words: tuple[str, ...] = ()
    if kind is CaseKind.TOF_BENCH:
        constant = "" if material is None else str(material.constant or "")
        words = log.columns[material.column] if material and material.column else (constant,) * log.rows
    if "t_s" not in values:
        values["t_s"] = LONG_AFTER_S + np.arange(log.rows)
        notes.append("no times were logged: rows count as taken long after the device was switched on")
    parts = _trials(values, words, kind, log, notes)
    if kind is CaseKind.DRIVE_LOG:
        _check_motion(parts, mapping.columns["t_s"], log)
        parts = [_unwrapped(part, "theta_rad") for part in parts]
        parts = _at_sample_times(parts, notes)
    names = held_otherwise(mapping, kind)
    if names:
        notes += left_out_notes([len(part.t_s) for part in parts], str(log.path))
        parts = [_Rows(*held_by_other_rows(part.t_s, part.values, names, kind)) for part in parts if len(part.t_s) > 1]
    elif kind is CaseKind.MOTOR_STEP:
        parts = _from_first_motion(parts, notes)
    if kind in IN_TIME:
        offsets = {name: source.time_offset_s for name, source in mapping.columns.items() if source.time_offset_s}
        parts = [_shifted(part, offsets) for part in parts]
        parts = _regular(parts, kind, log, notes)
    if faults := list(missing_inputs(mapping, values, [part.values for part in parts], log)):
        raise together(faults)
    source = MeasurementSource("a log", (str(log.path),))
    held = _holdout(parts, kind, notes)
    trials, begins_s = [], 0.0
    for number, (part, holdout) in enumerate(zip(parts, held, strict=True), 1):
        trials.append(_trial(f"{number}", part, holdout, kind, begins_s if kind in IN_TIME else 0.0))
        begins_s += float(part.t_s[-1]) + 1.0
    return Measurement(name, kind, source, tuple(trials), notes=tuple(notes))


def _values(log: LogFile, mapping: LogMapping, notes: list[str]) -> dict[str, Array]:
    """Return the numbers of a log in our units by our names, (N,) each; `notes` gets what was changed."""
    faults, values, kind = FaultList(), {}, CaseKind(mapping.kind)
    for name, column in KINDS[kind].scales.items():
        source = mapping.columns.get(name)
        if source is None:
            continue
        with faults.noted():
            if name in {"trial", "sweep"} and source.column:  # trials may have words for names
                cells = log.columns[source.column]
                number_of_name = {cell: float(k) for k, cell in enumerate(dict.fromkeys(cells))}
                numbers = np.array([number_of_name[cell] for cell in cells])
            elif source.constant is not None:
                numbers = np.full(log.rows, float(source.constant))
            else:
                factor = source.factor * factor_to(column.unit, source.unit, f"columns.{name}")
                with np.errstate(over="ignore"):  # what became too large is a fault
                    logged = source.times_of(log) if name == "t_s" else source.numbers(log)
                    numbers = factor * running_counts(logged, source, name, notes) + source.offset
                    if name in COUNTED and abs(source.factor) != 1.0:  # such as turns of the wheel
                        numbers = np.rint(numbers)
                _check_sizes(numbers, source, log)
            if name == "t_s" and (kind in IN_TIME or numbers[0] > LONG_AFTER_S):  # of a computer, from 1970
                numbers = numbers - numbers[0]
            values[name] = np.round(numbers, DECIMALS)
    if not faults.faults:
        faults.faults += unit_faults(mapping, KINDS[kind], values, log) or input_faults(mapping, values, log)
    faults.check()
    names = [name for name in values if name not in {"t_s", "trial", "sweep"}]
    notes += [
        f"{note}; short gaps are bridged where rows are sampled again" for note in missing_note(mapping, log, names)
    ]
    return values


def _check_sizes(numbers: Array, source: Source, log: LogFile) -> None:
    """Refuse a column of which a number is too large in our unit."""
    if len(large := np.flatnonzero(np.abs(numbers) > TOO_LARGE)):
        row = int(large[0])
        where, got = log.where(row), log.columns[source.column][row]
        cure = "correct the cell, or the unit and the factor of the column"
        raise InputError(f"column {source.column}: too large", where=where, got=got, cure=cure)


def _trials(
    values: Mapping[str, Array], words: Sequence[str], kind: CaseKind, log: LogFile, notes: list[str]
) -> list[_Rows]:
    t_s = values["t_s"]
    return [
        _Rows(
            t_s[rows],
            {name: column[rows] for name, column in values.items()},
            tuple(words[int(i)] for i in rows) if words else (),
        )
        for rows in rows_of_trials(t_s, values.get("trial", values.get("sweep")), kind, log, notes)
    ]


def _check_motion(parts: Sequence[_Rows], times: Source, log: LogFile) -> None:
    """Refuse a drive whose times are in a larger unit than was taken."""
    unit = larger_time_unit(unit_of(times.unit))
    cure = "are the times in a larger unit, or the places in a smaller one?"
    if unit:
        cure = f"if the times are in {unit}, write unit: {unit} for t_s"
    cure = f"{cure} in a {MAPPING} (docs/case_from_log.md), and give it with --mapping"
    for part in parts:
        absent = np.full(len(part.t_s), np.nan)
        place = np.column_stack([part.values.get(name, absent) for name in ("x_m", "y_m")])
        check_motion(part.t_s, place, lambda _row: str(log.path), cure, column=times.column)


def _at_sample_times(parts: Sequence[_Rows], notes: list[str]) -> Sequence[_Rows]:
    """Return the rows at even times where counts, or else poses, show that only the time stamps scatter."""
    names = [name for name in ("enc_left_ticks", "enc_right_ticks") if name in parts[0].values]
    names = names or [name for name in ("x_m", "y_m", "theta_rad") if name in parts[0].values]
    even_s = [even_times(part.t_s) for part in parts]
    columns = [[part.values[name] for name in names] for part in parts]
    if not are_even([part.t_s for part in parts], even_s, columns):
        return parts
    scatter_s = np.std(np.concatenate([part.t_s - even for part, even in zip(parts, even_s, strict=True)]))
    motion = "counts grow" if names[0].endswith("_ticks") else "poses move"
    notes.append(
        f"the times of rows scatter by {scatter_s:.2g} s, but {motion} evenly from row to row: rows are taken for "
        f"evenly sampled, {usual_step(np.diff(even_s[0])):.4g} s apart"
    )
    return [_Rows(even, part.values, part.words) for part, even in zip(parts, even_s, strict=True)]


def _from_first_motion(parts: Sequence[_Rows], notes: list[str]) -> Sequence[_Rows]:
    """Return the trials of a step log without a first row in which the voltage is on and the motor is still at rest.

    A case begins one sample after rest. If such a row counted as that sample, all speeds would seem a sample late.
    """
    if not {"u_cmd_V", "omega_rad_s"} <= parts[0].values.keys():
        return parts
    is_on = [len(part.t_s) > 2 and part.values["u_cmd_V"][0] != 0.0 for part in parts]
    speeds = [part.values["omega_rad_s"][:2] for part, on in zip(parts, is_on, strict=True) if on]
    first, second = np.nansum(np.abs(speeds), axis=0) if speeds else (0.0, 0.0)
    if not first < AT_REST * second:
        return parts
    notes.append(f"first rows in which the motor is still at rest: {len(speeds)}; they are left out")
    return [
        _Rows(part.t_s[1:], {name: column[1:] for name, column in part.values.items()}) if on else part
        for part, on in zip(parts, is_on, strict=True)
    ]


def _shifted(part: _Rows, offsets_s: Mapping[str, float]) -> _Rows:
    """Return the rows with those columns moved back to the time at which they were measured."""
    shifted = {
        name: _interpolated(part.t_s, part.t_s + offset_s, part.values[name])
        for name, offset_s in offsets_s.items()
        if name in part.values
    }
    return _Rows(part.t_s, {**part.values, **shifted}, part.words)


def _regular(parts: Sequence[_Rows], kind: CaseKind, log: LogFile, notes: list[str]) -> list[_Rows]:
    """Return the rows from the start of each trial, at the rate of the kind and sampled again where they are not."""
    steps = np.concatenate([np.diff(part.t_s) for part in parts])
    if not len(steps):
        raise InputError("no trial has two rows", where=str(log.path))
    step_s = usual_step(steps)
    wanted_s = row_of_drive_s(steps) if kind is CaseKind.DRIVE_LOG else step_s
    if kind is CaseKind.DRIVE_LOG and step_s > SLOWEST_S:
        cure = "log at 10 Hz or faster; slower rows say too little about turns and starts"
        if 1e-3 * step_s <= SLOWEST_S and step_s >= 1.0:
            cure = f"if the times are in ms, write unit: ms for t_s in {MAPPING}; otherwise, {cure}"
        raise InputError(
            f"rows are {step_s:.4g} s apart", where=str(log.path), allowed=f"at most {SLOWEST_S:g} s", cure=cure
        )
    off = np.quantile(np.abs(steps - wanted_s), 0.9)
    first_s = 0.0 if kind is CaseKind.DRIVE_LOG else wanted_s
    if off <= IRREGULAR[kind] * wanted_s:
        return [_Rows(part.t_s - part.t_s[0] + first_s, part.values, part.words) for part in parts]
    scatter_s = float(np.quantile(np.abs(steps - step_s), 0.9))
    within = f", 9 of 10 within {scatter_s:.2g} s" if scatter_s > 1e-3 * step_s else ""
    names = {name for part in parts for name, column in part.values.items() if np.isfinite(column).any()}
    notes.append(
        f"rows are {step_s:.4g} s apart{within}: sampled again every {wanted_s:.4g} s; "
        + in_words(names, has_all_times=all(has_times(part.t_s, wanted_s) for part in parts))
    )
    return [_sampled(part, step_s, wanted_s, first_s) for part in parts]


def _unwrapped(part: _Rows, name: str) -> _Rows:
    """Return the rows with an angle that continues beyond a whole turn, so that it can be interpolated."""
    if name not in part.values:
        return part
    angle = part.values[name].copy()
    known = np.isfinite(angle)
    angle[known] = np.unwrap(angle[known], period=whole_turn(angle[known]))
    return _Rows(part.t_s, {**part.values, name: angle}, part.words)


def _sampled(part: _Rows, step_s: float, wanted_s: float, first_s: float) -> _Rows:
    since_s = part.t_s - part.t_s[0]
    t_s = wanted_s * np.arange(int(np.floor(since_s[-1] / wanted_s + 1e-9)) + 1)
    values = {}
    for name, column in part.values.items():
        if name in RANGES:
            nearest = _nearest(since_s, t_s)
            close = np.abs(since_s[nearest] - t_s) <= max(step_s, 0.5 * wanted_s)
            values[name] = np.where(close, column[nearest], np.nan)
        elif is_input(name):
            values[name] = held_means(since_s, column, t_s, wanted_s)
        else:
            values[name] = _interpolated(t_s, since_s, column)
        if name.endswith("_ticks"):
            values[name] = np.rint(values[name])
    voltages = [name for name in WHEEL_VOLTAGES if np.isfinite(part.values.get(name, np.nan)).any()]
    held = tuple(_changes(name, since_s, part.values[name]) for name in voltages)
    return _Rows(t_s + first_s, values, held_inputs=held)


def _nearest(t_s: Array, wanted_s: Array) -> NDArray[np.int64]:
    after = np.clip(np.searchsorted(t_s, wanted_s), 1, max(len(t_s) - 1, 1))
    return np.where(wanted_s - t_s[after - 1] <= t_s[np.minimum(after, len(t_s) - 1)] - wanted_s, after - 1, after)


def _changes(name: str, since_s: Array, values: Array) -> TimeSeries:
    """Return the times at which a held value changes, with the new values."""
    known = np.isfinite(values)
    times, held = since_s[known], values[known]
    new = np.diff(held, prepend=np.nan) != 0.0
    return TimeSeries(name, "V", times[new].copy(), held[new].copy())


def _interpolated(wanted_s: Array, t_s: Array, values: Array) -> Array:
    """Return values between their neighbours; NaN in gaps and beyond both ends."""
    known = np.isfinite(values)
    if np.count_nonzero(known) < 2:
        return np.full(len(wanted_s), np.nan)
    times = t_s[known]
    result = np.interp(wanted_s, times, values[known], left=np.nan, right=np.nan)
    after = np.clip(np.searchsorted(times, wanted_s), 1, len(times) - 1)
    exact = np.isin(wanted_s, times)
    result[(times[after] - times[after - 1] > BRIDGED_STEPS * usual_step(np.diff(t_s))) & ~exact] = np.nan
    return result


def _holdout(parts: Sequence[_Rows], kind: CaseKind, notes: list[str]) -> list[NDArray[np.bool_]]:
    rows = [len(part.t_s) for part in parts]
    if kind not in IN_TIME:
        notes.append("every fourth row is held out")
        number = np.arange(sum(rows)) % HELD_OUT_EACH == HELD_OUT_EACH - 1
        return np.split(number, np.cumsum(rows)[:-1])
    if len(parts) >= HELD_OUT_EACH:
        notes.append("every fourth trial is held out")
        return [np.full(count, k % HELD_OUT_EACH == HELD_OUT_EACH - 1) for k, count in enumerate(rows)]
    held = [np.arange(count) >= round(0.75 * count) for count in rows]
    late = [_late_motion(part, last) for part, last in zip(parts, held, strict=True)]
    notes.append("the last quarter of each trial is held out")
    if any(late_rows.any() for late_rows in late):
        notes[-1] += "; where nothing moves in it, the rows after three quarters of the motion are"
    return [late_rows if late_rows.any() else last for late_rows, last in zip(late, held, strict=True)]


def _late_motion(part: _Rows, last: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the rows (N,) after three quarters of the motion, if hardly anything moves in the last ones; else none."""
    moved = np.zeros(len(part.t_s))
    for name in _MOVES:
        if name in part.values:
            moved += np.nan_to_num(np.abs(np.diff(part.values[name], prepend=np.nan)))
    if moved[last].sum() >= MIN_HELD_MOTION * moved.sum():
        return np.zeros_like(last)
    return np.cumsum(moved) > 0.75 * moved.sum()


def _trial(name: str, part: _Rows, holdout: NDArray[np.bool_], kind: CaseKind, begins_s: float) -> Trial:
    absent = np.full(len(part.t_s), np.nan)
    channels = tuple(
        Channel.logged(
            TimeSeries(
                column.name,
                column.unit,
                part.t_s,
                part.values[column.name].copy() if column.name in part.values else absent,
            ),
            Role(column.role),
            clock="camera" if column.name in CAMERA_CHANNELS else "log",
        )
        for column in channel_columns(kind)
    )
    labels = (Label("material", part.words),) if kind is CaseKind.TOF_BENCH else ()
    return Trial(name, part.t_s, holdout, channels, labels, begins_s, held_inputs=part.held_inputs)
