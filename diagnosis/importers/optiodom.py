"""Drives of a small differential robot with encoder counts and motion capture (the OptiOdom data, Sousa et al. 2022).

Each run is a file `<session>_run-NN.csv` without header, at 20 Hz, with the columns t [s], x, y [m], heading [rad],
counts of the right wheel in this row and counts of the left wheel. Each session has a `<session>_metadata.csv` with one
key and its values per row. Voltages and ranges were not logged. Odometry and motion capture had different clocks, which
the authors aligned at cut points; the remaining offset is not known. Every third run of a session is held out. Sessions
drive each path two to five times in a row, so that each path is both fitted and judged.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.importers.cases.order import check_increasing
from diagnosis.measured.case_files.csv_table import MeasuredColumn, table_of
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.holdout import EVERY
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.usual_tolerances import usual_wheels
from logs.recognition import is_file, is_folder
from logs.units.plausible import PlausibleRange
from symolo.core.errors import InputError
from symolo.core.files.text_file import read_text
from symolo.core.tables.table import number
from symolo.core.tables.time_series import TimeSeries

_RUN = re.compile(r"(\d+)_run-(\d+)\.csv")
_METADATA = "*_metadata.csv"
_PLACE = PlausibleRange(-50.0, 50.0)
_COUNTS = PlausibleRange(-10_000.0, 10_000.0)
COLUMNS = (
    MeasuredColumn("t_s", "s", Role.INPUT, PlausibleRange(0.0, 1e6), may_be_empty=False),
    MeasuredColumn("x_m", "m", Role.READING, _PLACE),
    MeasuredColumn("y_m", "m", Role.READING, _PLACE),
    MeasuredColumn("theta_rad", "rad", Role.READING, PlausibleRange(-1e4, 1e4)),
    MeasuredColumn("ticks_right", "ticks", Role.READING, _COUNTS, 0, may_be_empty=False),
    MeasuredColumn("ticks_left", "ticks", Role.READING, _COUNTS, 0, may_be_empty=False),
)

WHEEL_DIAMETER_M = 0.084
TRACK_M = 0.2
ENCODER_TICKS_PER_REVOLUTION = 43.7 * 64
"""Counts per turn of a wheel: gear ratio times counts per turn of the motor. In some sessions the controller used other
lengths of wheels and track than these nominal ones."""


def _runs(path: Path) -> Iterator[Path]:
    """Yield the runs of all sessions, which are the folders with a metadata file, up to two levels below a folder."""
    patterns = (_METADATA, f"*/{_METADATA}", f"*/*/{_METADATA}")
    for session in {file.parent for pattern in patterns for file in path.glob(pattern)}:
        yield from (file for file in session.iterdir() if _RUN.fullmatch(file.name))


def _recognises(path: Path) -> bool:
    if is_file(path):
        return _RUN.fullmatch(path.name) is not None
    return is_folder(path) and any(True for _ in _runs(path))


def _read(path: Path) -> Measurement:
    files = [path] if is_file(path) else sorted(_runs(path))
    if not files:
        raise InputError(
            "holds no <session>_run-NN.csv", where=str(path), cure="name a session, or a folder of sessions"
        )
    logs = [_trial(file, alone=len(files) == 1) for file in files]
    lengths = {file.parent: _metadata(file.parent) for file in files}
    notes = [note for _, notes in logs for note in notes]
    notes += ["not logged: voltages, ranges"]
    held = any(trial.holdout.all() for trial, _ in logs)
    notes += ["every third run of a session is held out" if held else "nothing is held out"]
    notes += [
        f"{folder.name} was driven with a wheel separation of {values['Li'][0]:g} m and wheel diameters of "
        f"{values['Di'][0]:g} m in its controller; the counts do not depend on it"
        for folder, values in lengths.items()
        if (values["Li"][0], values["Di"][0]) != (TRACK_M, WHEEL_DIAMETER_M)
    ]
    source = MeasurementSource(
        "OptiOdom: encoder counts and OptiTrack poses of a differential robot, INESC TEC",
        tuple(str(file) for file in files),
        "MIT",
    )
    trials = tuple(trial for trial, _ in logs)
    nominal = usual_wheels(diameter_m=WHEEL_DIAMETER_M, track_m=TRACK_M, counts_per_turn=ENCODER_TICKS_PER_REVOLUTION)
    name = path.absolute().name
    return Measurement(name, CaseKind.DRIVE_LOG, source, trials, nominal, tuple(dict.fromkeys(notes)))


def _trial(path: Path, *, alone: bool) -> tuple[Trial, Sequence[str]]:
    table = table_of(read_text(path), COLUMNS, range(len(COLUMNS)), first=0)
    check_increasing(table, "t_s")
    t_s = table.numbers["t_s"]
    counts = {side: np.cumsum(table.numbers[f"ticks_{side}"]) for side in ("left", "right")}
    channels = [
        Channel.logged(TimeSeries(f"enc_{side}_ticks", "ticks", t_s, values), Role.READING)
        for side, values in counts.items()
    ]
    channels += [
        Channel.logged(
            TimeSeries(column.name, column.unit, t_s, table.numbers[column.name]), column.role, clock="camera"
        )
        for column in COLUMNS[1:4]
    ]
    name = f"{path.parent.parent.name}/{path.stem}"
    run = _RUN.fullmatch(path.name)
    is_held = not alone and run is not None and int(run[2]) % EVERY == 0
    return Trial(name, t_s, np.full(len(t_s), is_held), tuple(channels), session=path.parent.name), table.notes


def _metadata(session: Path) -> Mapping[str, tuple[float, ...]]:
    """Return the numbers of the keys Li [m], the wheel separation, and Di [m], the wheel diameters."""
    lengths: dict[str, tuple[float, ...]] = {}
    for file in sorted(session.glob(_METADATA)):
        for row, line in enumerate(read_text(file).lines, 1):
            key, *cells = line.split(",")
            if key in {"Li", "Di"}:
                lengths[key] = tuple(number(cell, "2", f"{file}: row {row}") for cell in cells if cell.strip())
    for key in ("Li", "Di"):
        if not lengths.get(key):
            raise InputError(
                f"there is no row {key}", where=str(session / _METADATA), cure="put its metadata file there"
            )
    return lengths


IMPORTER = Importer("optiodom", _recognises, _read)
