"""Inputs of unseen runs, which lie beside a measured case and whose readings are to be predicted."""

from pathlib import Path

import numpy as np

from diagnosis.importers.cases.trials import trials_of
from diagnosis.measured.case_files.case_format import BLIND, COLUMNS, channel_columns
from diagnosis.measured.case_files.csv_table import read_csv
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource
from logs.recognition import is_file


def read_blind(folder: Path, kind: CaseKind) -> dict[str, Measurement]:
    """Return the unseen runs of a case by file name, in the order of the format; empty if there are none.

    Every row is held out. `blind_pose_inputs.csv` has a pose in its first row only.

    Raises:
        InputError: A file breaks the format; the message names file, row and column.
    """
    return {name: _read(folder / name, kind) for name in BLIND[kind] if is_file(folder / name)}


def _read(path: Path, kind: CaseKind) -> Measurement:
    columns = [column for column in COLUMNS[kind] if column.name in BLIND[kind][path.name]]
    table = read_csv(path, columns)
    channels = [column for column in channel_columns(kind) if column in columns]
    trials = trials_of(table, channels, np.ones(len(table.row), dtype=bool), {}, from_rest=kind is CaseKind.MOTOR_STEP)
    source = MeasurementSource("inputs of unseen runs", (str(path),))
    return Measurement(path.stem, kind, source, trials, notes=table.notes)
