"""Importer of the four kinds of measured case: a folder with nominal.yaml and data.csv."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TypeVar

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.importers.cases.held_voltages import with_held_voltages
from diagnosis.importers.cases.trials import KnownNoise, trials_of
from diagnosis.measured.case_files.case_format import COLUMNS, DATA, HOLDOUT, SPLIT, VOLTAGES, channel_columns
from diagnosis.measured.case_files.csv_table import read_csv
from diagnosis.measured.case_files.nominal import NOMINAL, NominalCase, read_nominal
from diagnosis.measured.measurement import CHECK_UNIT, CaseKind, Measurement, MeasurementSource
from logs.recognition import is_file
from logs.units.plausible import confused_units
from symolo.core.errors import FaultList, InputError, together
from symolo.core.files.plain_files import open_named_file
from symolo.core.tables.table import CsvTable
from symolo.core.yaml.reader import MAX_BYTES, parse_yaml

Parameters = TypeVar("Parameters", bound=NominalCase)
NoiseOf = Callable[[Parameters, CsvTable, str], KnownNoise | None]
"""Function that returns the stated noise of a channel in every row of the table, or None."""
NotesOf = Callable[[Parameters, Measurement], Sequence[str]]
"""Function that checks the data against their nominal parameters and returns notes for the user."""


def case_importer(
    kind: CaseKind, model: type[Parameters], noise_of: NoiseOf[Parameters], notes_of: NotesOf[Parameters]
) -> Importer:
    """Return the importer of one kind of case, whose nominal parameters are an instance of `model`."""
    return Importer(kind.value, partial(recognises, kind), partial(_read, kind, model, noise_of, notes_of))


def recognises(kind: CaseKind, path: Path) -> bool:
    """Return whether nominal.yaml names this kind, even if the rest of the file is not valid YAML.

    A broken file is thus read by the importer of its kind, whose message names the fault.
    """
    file = case_folder(path) / NOMINAL
    if not is_file(file):
        return False
    try:
        with open_named_file(file) as opened:
            text = opened.read(MAX_BYTES).decode("utf-8-sig", errors="replace")
    except (OSError, ValueError):
        return False
    return _kind_in(text) == kind.value


@lru_cache(maxsize=1)
def _kind_in(text: str) -> object:
    """Return the value of `kind` in a text of YAML; None if it has none, or is not valid and has no line for it.

    The importer of each kind asks, and a long text takes long to parse, so that it is parsed only where no line begins
    with the key, and only once.
    """
    line = re.search(r"^kind:\s*['\"]?(\w+)['\"]?\s*(#.*)?\r?$", text, re.MULTILINE)
    if line is not None:
        return line[1]
    try:
        kind = parse_yaml(text, NOMINAL).child("kind")
    except InputError:
        return None
    return kind.plain() if kind else None


def case_folder(path: Path) -> Path:
    return path.parent if path.name in {DATA, NOMINAL} else path


def _read(
    kind: CaseKind, model: type[Parameters], noise_of: NoiseOf[Parameters], notes_of: NotesOf[Parameters], path: Path
) -> Measurement:
    folder, faults = case_folder(path), FaultList()
    for name in (NOMINAL, DATA):
        if not (folder / name).is_file():
            cure = f"name a folder with {NOMINAL} and {DATA}"
            raise InputError(f"there is no {name}", where=str(folder), cure=cure)
    nominal, table = None, None
    with faults.noted():
        nominal = _nominal(folder / NOMINAL, kind, model)
    with faults.noted():
        table = read_csv(folder / DATA, COLUMNS[kind], may_lack_columns=True)
    if table is None:
        raise together(faults.faults)
    channels = channel_columns(kind)
    noise: dict[str, KnownNoise] = {}
    if nominal is not None:
        with faults.noted():
            noise = {c.name: known for c in channels for known in (noise_of(nominal, table, c.name),) if known}
    holdout = np.array(table.words[SPLIT.name]) == HOLDOUT
    trials = ()
    with faults.noted():
        trials = trials_of(table, channels, holdout, noise, from_rest=kind is CaseKind.MOTOR_STEP)
    if kind is CaseKind.DRIVE_LOG and trials and is_file(folder / VOLTAGES):
        with faults.noted():
            trials = with_held_voltages(trials, folder / VOLTAGES)
    if nominal is None or not trials:
        raise together(faults.faults)
    source = MeasurementSource("a measured case", (str(folder / DATA), str(folder / NOMINAL)))
    measurement = Measurement(folder.absolute().name, kind, source, trials, nominal)
    names = [n for n in measurement.channel_names() if not any(c.is_offered for c in measurement.across(n))]
    absent = [f"not logged: {', '.join(names)}"] if names else []
    with faults.noted():
        absent += notes_of(nominal, measurement)
    faults.check()
    return replace(measurement, notes=(*table.notes, *absent))


def _nominal(file: Path, kind: CaseKind, model: type[Parameters]) -> Parameters:
    nominal = read_nominal(file)
    if not isinstance(nominal, model):
        raise InputError("kind", where=str(file), got=nominal.kind, allowed=kind.value)
    return nominal


def scale_note(ratio: float, name: str, unit: str, reference: str) -> list[str]:
    """Return a note if the ratio of a channel to a reference value is that of two units; else an empty list."""
    other = confused_units(ratio, unit) if np.isfinite(ratio) and ratio > 0.0 else ""
    if not other:
        return []
    return [f"{CHECK_UNIT} of {name}: it is about {ratio:.3g} times {reference}, as if it were in {other}"]
