"""What the four kinds of measured case have in common: a folder with nominal.yaml and data.csv, rows in trials."""

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer, is_file
from diagnosis.importers.trials import KnownNoise, trials_of
from diagnosis.measured.case_format import COLUMNS, DATA, HOLDOUT, SPLIT, channel_columns
from diagnosis.measured.csv_table import read_csv
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource
from diagnosis.measured.nominal import NOMINAL, Nominal, kind_of, read_nominal
from diagnosis.measured.scale import mixed_up_unit
from symolo.core.errors import InputError
from symolo.core.files.plain_files import open_named_file
from symolo.core.table import CsvTable

NoiseOf = Callable[[Nominal, CsvTable, str], KnownNoise | None]
"""Known noise of a channel in every row of the table, or None."""
NotesOf = Callable[[Nominal, Measurement], Sequence[str]]
"""What is odd about the data beside their nominal parameters."""


def case_importer(kind: CaseKind, what: str, noise_of: NoiseOf, notes_of: NotesOf) -> Importer:
    """The importer of one kind of case."""
    read = partial(_read, kind, noise_of, notes_of)
    return Importer(kind.value, what, partial(_recognises, kind), read)


def _recognises(kind: CaseKind, path: Path) -> bool:
    """By nominal.yaml's own word, be it YAML or nearly so, so that its faults are told by the reader it belongs to."""
    file = _folder(path) / NOMINAL
    if not is_file(file):
        return False
    try:
        return kind_of(file) == kind.value
    except InputError:
        pass
    try:
        with open_named_file(file) as opened:
            text = opened.read(100_000).decode("utf-8-sig", errors="replace")
    except (OSError, ValueError):
        return False
    return re.search(rf"^kind:\s*['\"]?{kind.value}['\"]?\s*(#.*)?\r?$", text, re.MULTILINE) is not None


def _folder(path: Path) -> Path:
    return path.parent if path.name in {DATA, NOMINAL} else path


def _read(kind: CaseKind, noise_of: NoiseOf, notes_of: NotesOf, path: Path) -> Measurement:
    folder = _folder(path)
    for name in (NOMINAL, DATA):
        if not (folder / name).is_file():
            cure = f"name a folder with {NOMINAL} and {DATA}"
            raise InputError(f"there is no {name}", where=str(folder), cure=cure)
    nominal = read_nominal(folder / NOMINAL)
    if nominal.kind != kind:
        raise InputError("kind", where=str(folder / NOMINAL), got=nominal.kind, allowed=kind.value)
    table = read_csv(folder / DATA, COLUMNS[kind])
    source = MeasurementSource("a measured case", (str(folder / DATA), str(folder / NOMINAL)))
    channels = channel_columns(kind)
    noise = {c.name: known for c in channels for known in (noise_of(nominal, table, c.name),) if known is not None}
    trials = trials_of(
        table, channels, np.array(table.words[SPLIT.name]) == HOLDOUT, noise, from_rest=kind is CaseKind.MOTOR_STEP
    )
    measurement = Measurement(folder.absolute().name, kind, source, trials, nominal, table.notes)
    notes = (*table.notes, *_absent(measurement), *notes_of(nominal, measurement))
    return Measurement(measurement.name, kind, source, trials, nominal, notes)


def _absent(measurement: Measurement) -> list[str]:
    names = [n for n in measurement.channel_names() if not any(c.is_offered for c in measurement.across(n))]
    return [f"not logged: {', '.join(names)}"] if names else []


def scale_note(ratio: float, name: str, unit: str, beside: str) -> list[str]:
    """What to say where a channel is about a unit's factor larger than what it is held against."""
    other = mixed_up_unit(ratio, unit) if np.isfinite(ratio) and ratio > 0.0 else ""
    if not other:
        return []
    return [f"CHECK THE UNIT of {name}: it is about {ratio:.3g} times {beside}, as if it were in {other}"]
