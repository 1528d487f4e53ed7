"""Runs of symolo as measured data: one run folder, or all runs of a release or of an output of `simulate`."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from pydantic import ValidationError

from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from diagnosis.importers.base import Importer, is_file
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from pipeline.diagnosing.importers.data_csv import row_channels, trial_of
from pipeline.stages.assemble import DATA, SIDE
from pipeline.stages.simulate_runs import SPEC, TRAJECTORY, read_recording
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.time_series import TimeSeries
from symolo.dataset.codes import TofStatus
from symolo.dataset.documents.metadata import METADATA
from symolo.dataset.layout import STAGES
from symolo.dataset.tables.rows import HEADER, Rows, parse_table, read_rows
from symolo.dataset.tables.side_reading import read_side
from symolo.dataset.tables.side_tables import TOF, WHEELS, tof_csv, wheels_csv

_DRIVE = {
    "v_cmd_m_s": ("command_v", "m/s", Role.INPUT),
    "w_cmd_rad_s": ("command_w", "rad/s", Role.INPUT),
    "enc_left_ticks": ("counts_l", "ticks", Role.READING),
    "enc_right_ticks": ("counts_r", "ticks", Role.READING),
    "current_left_A": ("current_l", "A", Role.READING),
    "current_right_A": ("current_r", "A", Role.READING),
    "omega_left_rad_s": ("speed_l", "rad/s", Role.READING),
    "omega_right_rad_s": ("speed_r", "rad/s", Role.READING),
}
"""Channel -> column of side/wheels.csv, unit, role."""
_VOLTAGES = {"u_left_V": "mean_voltage_l", "u_right_V": "mean_voltage_r"}
"""Channel -> column. A row of the column is about the time since the row before, one of the channel about the time to
the next row."""
_NOTE = (
    "a voltage is the mean from its row to the next, between which the wheel loop changes it; it drives a motor to the "
    "same place as the loop does but for its ripple"
)
HELD = 4
"""Every 4th run is held out; of fewer than 4 runs, the last quarter of each."""


@dataclass(frozen=True)
class _DatasetRun:
    """One run, released or simulated."""

    folder: Path
    simulated: bool

    @property
    def name(self) -> str:
        folder = self.folder.absolute()
        return f"{folder.parent.name}/{folder.name}"

    @property
    def files(self) -> tuple[str, ...]:
        names = (TRAJECTORY,) if self.simulated else (DATA, f"{SIDE}/{WHEELS.file}", f"{SIDE}/{TOF.file}")
        return tuple(str(self.folder / name) for name in names)

    def tables(self) -> tuple[Rows, Array, Array]:
        """Return data.csv, side/wheels.csv and side/tof.csv.

        Raises:
            InputError: One of them is missing, of another form, or at other times.
        """
        if not self.simulated:
            rows = read_rows(self.folder / DATA)
            wheels, tof = (read_side(self.folder / SIDE / table.file, table, rows) for table in (WHEELS, TOF))
            return rows, wheels, tof
        try:
            recording = read_recording(self.folder)
        except (OSError, ValueError, KeyError, BadZipFile) as error:
            raise InputError(f"cannot be read: {error}", where=self.files[0], cure="simulate again") from None
        # As text and back, so that a run says the same before and after its release.
        texts = (Rows.from_recording(recording).to_csv(), wheels_csv(recording), tof_csv(recording))
        headers = (HEADER, WHEELS.header, TOF.header)
        data, wheels, tof = (parse_table(text, header)[0] for text, header in zip(texts, headers, strict=True))
        return Rows.from_table(data), wheels, tof


def robots_of(path: Path) -> list[RobotConfig]:
    """Return the robots of the runs of a dataset, each once.

    Raises:
        InputError: There is no run, or one does not state its robot.
    """
    robots: dict[str, RobotConfig] = {}
    for run in _runs_or_error(path):
        spec = run.folder / SPEC if run.simulated else run.folder / SIDE / SPEC
        try:
            robot = RunSpec.model_validate_json(read_file(spec, FileKind.DOCUMENT)).robot
        except (OSError, ValidationError):
            raise InputError("does not say which robot drove", where=str(spec), cure="make the run again") from None
        robots.setdefault(robot.model_dump_json(), robot)
    return list(robots.values())


def _runs(path: Path) -> Iterator[_DatasetRun]:
    """Yield the run at this path, or all runs of a release or of an output of `simulate`."""
    if path.name == DATA:
        path = path.parent
    if is_file(path / DATA) and is_file(path / SIDE / WHEELS.file):
        yield _DatasetRun(path, simulated=False)
    elif is_file(path / METADATA):
        for folder in sorted(path.glob(f"*/*/{SIDE}")):
            if is_file(folder.parent / DATA):
                yield _DatasetRun(folder.parent, simulated=False)
    elif is_file(path / TRAJECTORY):
        yield _DatasetRun(path, simulated=True)
    else:
        for file in sorted(path.glob(f"{STAGES}/simulate/*/*/{TRAJECTORY}")):
            yield _DatasetRun(file.parent, simulated=True)


def _recognises(path: Path) -> bool:
    return next(_runs(path), None) is not None


def _runs_or_error(path: Path) -> list[_DatasetRun]:
    runs = list(_runs(path))
    if not runs:
        raise InputError(
            "is no run of a dataset",
            where=str(path),
            cure="name a folder such as OUT/CW/test_1, a release, or what simulate made",
        )
    return runs


def _read(path: Path) -> Measurement:
    runs = _runs_or_error(path)
    several = len(runs) >= HELD
    trials = []
    for number, run in enumerate(runs, start=1):
        trial = _trial(run)
        rows = len(trial.t_s)
        held = np.full(rows, number % HELD == 0) if several else np.arange(rows) >= rows - rows // HELD
        trials.append(replace(trial, holdout=held))
    files = tuple(file for run in runs for file in run.files)
    share = f"every {HELD}th run" if several else f"the last {1.0 / HELD:.0%} of each run"
    notes = (_NOTE, f"{share} is held out")
    name = path.absolute().parent.name if path.name == DATA else path.absolute().name
    return Measurement(
        name, CaseKind.DRIVE_LOG, MeasurementSource("a dataset of symolo", files), tuple(trials), notes=notes
    )


def _trial(run: _DatasetRun) -> Trial:
    rows, wheels, tof = run.tables()
    t_s = 1e-3 * rows.t_ms
    drive = [
        Channel.logged(TimeSeries(name, unit, t_s, wheels[:, WHEELS.header.index(column)].copy()), role)
        for name, (column, unit, role) in _DRIVE.items()
    ]
    for name, column in _VOLTAGES.items():
        mean_V = np.append(wheels[1:, WHEELS.header.index(column)], np.nan)
        drive.append(Channel.logged(TimeSeries(name, "V", t_s, mean_V), Role.INPUT))
    status = tof[:, 1:]
    seen = row_channels(rows, status == TofStatus.NO_TARGET, status == TofStatus.HELD)
    return trial_of(run.name, rows, (*drive, *seen))


IMPORTER = Importer("run", _recognises, _read)
