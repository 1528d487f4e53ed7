"""What the four kinds of measured case have in common: a folder with nominal.yaml and data.csv, rows in trials."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from configs.errors import InputError
from diagnosis.importers.base import Importer
from diagnosis.importers.order import check_increasing
from diagnosis.measured.case_format import CAMERA_CHANNELS, COLUMNS, DATA, HOLDOUT, NO_TARGET_FROM_M, RANGES
from diagnosis.measured.case_format import channel_columns as columns_of
from diagnosis.measured.channel import Array, Channel, Label
from diagnosis.measured.csv_table import Column, Table, read_csv
from diagnosis.measured.measurement import Kind, Measurement, Source, Trial
from diagnosis.measured.nominal import NOMINAL, Nominal, read_nominal
from diagnosis.measured.scale import mixed_up_unit
from physics.trajectory import TimeSeries


@dataclass(frozen=True)
class KnownNoise:
    """Of one channel in some rows, from nominal.yaml."""

    sd: Array
    correlation: float = 0.0


NoiseOf = Callable[[Nominal, Table, str], KnownNoise | None]
"""Known noise of a channel in every row of the table, or None."""
NotesOf = Callable[[Nominal, Measurement], Sequence[str]]
"""What is odd about the data beside their nominal parameters."""


def case_importer(kind: Kind, what: str, noise_of: NoiseOf, notes_of: NotesOf) -> Importer:
    """The importer of one kind of case."""
    read = partial(_read, kind, noise_of, notes_of)
    return Importer(kind.value, what, partial(_recognises, kind), read)


def _recognises(kind: Kind, path: Path) -> bool:
    """By nominal.yaml's own word, faulty or not, so that its faults are told by the reader it belongs to."""
    file = _folder(path) / NOMINAL
    try:
        text = file.read_text(encoding="utf-8-sig", errors="replace")[:100_000]
    except (OSError, ValueError):
        return False
    return re.search(rf"^kind:\s*['\"]?{kind.value}['\"]?\s*(#.*)?\r?$", text, re.MULTILINE) is not None


def _folder(path: Path) -> Path:
    return path.parent if path.name in {DATA, NOMINAL} else path


def _read(kind: Kind, noise_of: NoiseOf, notes_of: NotesOf, path: Path) -> Measurement:
    folder = _folder(path)
    for name in (NOMINAL, DATA):
        if not (folder / name).is_file():
            cure = f"name a folder with {NOMINAL} and {DATA}"
            raise InputError(f"there is no {name}", where=str(folder), cure=cure)
    nominal = read_nominal(folder / NOMINAL)
    if nominal.kind != kind:
        raise InputError("kind", where=str(folder / NOMINAL), got=nominal.kind, allowed=kind.value)
    table = read_csv(folder / DATA, COLUMNS[kind])
    source = Source("a measured case", (str(folder / DATA), str(folder / NOMINAL)))
    trials = _trials(kind, table, {c.name: noise_of(nominal, table, c.name) for c in columns_of(kind)})
    measurement = Measurement(folder.absolute().name, kind, source, trials, nominal, table.notes)
    notes = (*table.notes, *_absent(measurement), *notes_of(nominal, measurement))
    return Measurement(measurement.name, kind, source, trials, nominal, notes)


def _trials(kind: Kind, table: Table, noise: dict[str, KnownNoise | None]) -> tuple[Trial, ...]:
    group = "sweep" if kind is Kind.MOTOR_STEADY else "trial" if "trial" in table.numbers else ""
    numbers = table.numbers[group] if group else np.ones(len(table.row))
    starts = [0, *(np.flatnonzero(np.diff(numbers)) + 1), len(numbers)]
    _check_order(table, numbers, group)
    return tuple(_trial(kind, table, noise, slice(a, b), f"{numbers[a]:.0f}") for a, b in pairwise(starts))


def _check_order(table: Table, numbers: Array, group: str) -> None:
    """Rows of a trial belong together, and time goes forward within each."""
    changes = np.flatnonzero(np.diff(numbers)) + 1
    seen = {numbers[0]}
    for i in changes:
        if numbers[i] in seen:
            cure = "sort the rows by it and by time"
            raise InputError(f"column {group}: {numbers[i]:.0f} comes again", where=table.where(i), cure=cure)
        seen.add(numbers[i])
    within = np.ones(len(numbers) - 1, dtype=bool)
    within[changes - 1] = group == "sweep"  # the time of a steady state counts on from sweep to sweep
    check_increasing(table, "t_s", within)
    if "row" in table.numbers:
        check_increasing(table, "row")
    if "session_time_s" in table.numbers:
        check_increasing(table, "session_time_s", within)
        back = changes[np.diff(table.numbers["session_time_s"])[changes - 1] < 0.0]
        if len(back):
            what = "column session_time_s: the trial begins before the one above has ended"
            raise InputError(what, where=table.where(int(back[0])), cure="put the trials in order")


def _trial(kind: Kind, table: Table, noise: dict[str, KnownNoise | None], rows: slice, name: str) -> Trial:
    t_s = table.numbers["t_s"][rows].copy()
    begins_s = float(table.numbers["session_time_s"][rows][0] - t_s[0]) if "session_time_s" in table.numbers else 0.0
    channels = tuple(_channel(column, t_s, table, rows, noise[column.name]) for column in columns_of(kind))
    holdout = np.array(table.words["split"][rows]) == HOLDOUT
    labels = tuple(Label(word, values[rows]) for word, values in table.words.items() if word != "split")
    return Trial(name, t_s, holdout, channels, labels, begins_s)


def _channel(column: Column, t_s: Array, table: Table, rows: slice, noise: KnownNoise | None) -> Channel:
    values = table.numbers[column.name][rows].copy()
    return Channel.logged(
        TimeSeries(column.name, column.unit, t_s, values),
        column.role,
        no_target=values >= NO_TARGET_FROM_M if column.name in RANGES else None,
        noise_sd=noise.sd[rows].copy() if noise else None,
        noise_correlation=noise.correlation if noise else 0.0,
        clock="camera" if column.name in CAMERA_CHANNELS else "log",
    )


def _absent(measurement: Measurement) -> list[str]:
    names = [n for n in measurement.channel_names() if not any(c.is_offered for c in measurement.across(n))]
    return [f"not logged: {', '.join(names)}"] if names else []


def constant(value: float, table: Table, correlation: float = 0.0) -> KnownNoise:
    """The same noise in every row."""
    return KnownNoise(np.full(len(table.row), value), correlation)


def scale_note(ratio: float, name: str, unit: str, beside: str) -> list[str]:
    """What to say where a channel is about a unit's factor larger than what it is held against."""
    other = mixed_up_unit(ratio, unit) if np.isfinite(ratio) and ratio > 0.0 else ""
    if not other:
        return []
    return [f"CHECK THE UNIT of {name}: it is about {ratio:.3g} times {beside}, as if it were in {other}"]
