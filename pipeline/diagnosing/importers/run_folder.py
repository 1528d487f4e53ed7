"""Runs of symolo as measured data: one run folder, or all runs of a release or of an output of `simulate`."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from configs.schema.robot import RobotConfig
from configs.schema.scenario import SceneSpec
from diagnosis.importers.base import Importer
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from logs.columns.drive import DRIVE_TABLE
from logs.recognition import is_file
from pipeline.diagnosing.importers.data_csv import row_channels, trial_of
from pipeline.run_folder.first_stage import TRAJECTORY
from pipeline.run_folder.stored_runs import read_simulated, run_name, simulated_folders, tables_of
from pipeline.run_folder.stored_spec import read_spec
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.tables.time_series import TimeSeries
from symolo.dataset.codes import TofStatus
from symolo.dataset.documents.metadata import METADATA, read_metadata
from symolo.dataset.layout import DATA, SIDE, SPEC
from symolo.dataset.tables.rows import RANGES, Rows, read_rows
from symolo.dataset.tables.side_reading import read_side
from symolo.dataset.tables.side_tables import TOF, WHEELS

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
_VOLTAGES = {"u_left_V": ("mean_voltage_l", "voltage_l"), "u_right_V": ("mean_voltage_r", "voltage_r")}
"""Channel -> columns. A row of the first column is the mean since the row before; a row of the channel is the mean
until the next row. A row of the second column is the last voltage before it."""
_NOTE = (
    "a voltage is the mean from its row to the next, between which the wheel loop changes it; it is taken to change "
    "evenly to its last value in the row"
)
UPDATES = 5
"""Updates of the wheel loop in a row, at the rates of the shipped scenarios."""
HELD_OUT_EACH = 4
"""Every 4th run is held out; of fewer than 4 runs, the last quarter of each."""


@dataclass(frozen=True)
class _DatasetRun:
    """One run, released or simulated."""

    folder: Path
    simulated: bool

    @property
    def files(self) -> tuple[str, ...]:
        names = (TRAJECTORY,) if self.simulated else (DATA, f"{SIDE}/{WHEELS.file}", f"{SIDE}/{TOF.file}")
        if self.is_imported:
            names = (DATA,)
        return tuple(str(self.folder / name) for name in names)

    @cached_property
    def spec(self) -> SceneSpec | None:
        """The specification of the run; None if it was removed, as it has the robot."""
        path = self.folder / SPEC if self.simulated else self.folder / SIDE / SPEC
        return read_spec(path) if is_file(path) else None

    @property
    def is_imported(self) -> bool:
        """Whether the trajectory was imported from a log, so that it has only the tables that were measured."""
        return self.spec is not None and self.spec.is_imported

    @property
    def is_rendered_again(self) -> bool:
        """Whether `rerender` made the images, so that the specification may have an arena that nobody measured."""
        return self.spec is not None and self.spec.origin is not None and self.spec.origin.release is not None

    def tables(self) -> tuple[Rows, Array, Array]:
        """Return data.csv, side/wheels.csv and side/tof.csv.

        Raises:
            InputError: One of them is missing, of another form, or at other times.
        """
        if self.simulated:
            return tables_of(read_simulated(self.folder))
        rows = read_rows(self.folder / DATA)
        wheels, tof = (read_side(self.folder / SIDE / table.file, table, rows) for table in (WHEELS, TOF))
        return rows, wheels, tof


def robots_of(path: Path) -> list[RobotConfig]:
    """Return the robots of the runs of a dataset, each once.

    Raises:
        InputError: There is no run, or one does not state its robot.
    """
    robots: dict[str, RobotConfig] = {}
    for run in _runs_or_error(path):
        robot = read_spec(run.folder / SPEC if run.simulated else run.folder / SIDE / SPEC).robot
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
    elif is_file(path / DATA) and is_file(path / SIDE / SPEC):
        yield _DatasetRun(path, simulated=False)
    elif is_file(path / TRAJECTORY):
        yield _DatasetRun(path, simulated=True)
    else:
        for folder in simulated_folders(path):
            yield _DatasetRun(folder, simulated=True)


def _recognises(path: Path) -> bool:
    try:
        return next(_runs(path), None) is not None
    except PermissionError:  # a link is refused with its name, but what is out of reach may be of another form
        return False


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
    several = len(runs) >= HELD_OUT_EACH
    trials = []
    for number, run in enumerate(runs, start=1):
        trial = _trial(run)
        rows = len(trial.t_s)
        holdout = (
            np.full(rows, number % HELD_OUT_EACH == 0) if several else np.arange(rows) >= rows - rows // HELD_OUT_EACH
        )
        trials.append(replace(trial, holdout=holdout))
    files = tuple(file for run in runs for file in run.files)
    share = f"every {HELD_OUT_EACH}th run" if several else f"the last {1.0 / HELD_OUT_EACH:.0%} of each run"
    notes = (*(() if runs[0].is_imported else (_NOTE,)), f"{share} is held out")
    without_spec = ", ".join(run_name(run.folder) for run in runs if run.spec is None)
    if without_spec:
        notes = (*notes, f"ranges are not compared: no {SPEC}, which states the arena, in {without_spec}")
    rendered_again = ", ".join(run_name(run.folder) for run in runs if run.is_rendered_again)
    if rendered_again:
        what = "rendered again, perhaps in another arena than that of the readings"
        notes = (*notes, f"ranges are not compared: {rendered_again} was {what}")
    name = path.absolute().parent.name if path.name == DATA else path.absolute().name
    source = MeasurementSource("logs that symolo imported" if runs[0].is_imported else "a dataset of symolo", files)
    return Measurement(name, CaseKind.DRIVE_LOG, source, tuple(trials), notes=notes)


def _trial(run: _DatasetRun) -> Trial:
    if run.is_imported:
        return _imported_trial(run)
    rows, wheels, tof = run.tables()
    t_s = 1e-3 * rows.t_ms
    drive = [
        Channel.logged(TimeSeries(name, unit, t_s, wheels[:, WHEELS.header.index(column)].copy()), role)
        for name, (column, unit, role) in _DRIVE.items()
    ]
    held = []
    for name, columns in _VOLTAGES.items():
        mean_V, last_V = (wheels[1:, WHEELS.header.index(column)] for column in columns)
        drive.append(Channel.logged(TimeSeries(name, "V", t_s, np.append(mean_V, np.nan)), Role.INPUT))
        held.append(_held(name, t_s, mean_V, last_V))
    status = tof[:, 1:]
    seen = row_channels(rows, status == TofStatus.NO_TARGET, status == TofStatus.HELD)
    # Of the specification, a diagnosis may know the arena, and must not know the robot.
    arena = run.spec.arena if run.spec and not run.is_rendered_again else None
    return replace(trial_of(run_name(run.folder), rows, (*drive, *seen)), held_inputs=tuple(held), arena=arena)


def _held(name: str, t_s: Array, mean_V: Array, last_V: Array) -> TimeSeries:
    """Return the voltages of the updates of the wheel loop, with the mean and the last one of each row.

    Between rows they are not logged. Steps of equal size are the simplest curve with both: by a mean alone the motor
    would turn too early in a row in which its voltage rises, which looks like a delay.

    Args:
        name: Channel.
        t_s: (n,), times of the rows.
        mean_V: (n - 1,), mean voltage of each row.
        last_V: (n - 1,), last voltage of each row.
    """
    number = np.arange(UPDATES)
    times = t_s[:-1, None] + np.diff(t_s)[:, None] * number / UPDATES
    volts = mean_V[:, None] + (last_V - mean_V)[:, None] * (2.0 * number / (UPDATES - 1) - 1.0)
    return TimeSeries(name, "V", times.ravel(), volts.ravel())


def _imported_trial(run: _DatasetRun) -> Trial:
    """Return what a log measured: columns of data.csv, and of side/drive.csv if there is one."""
    rows, spec = read_rows(run.folder / DATA), read_spec(run.folder / SIDE / SPEC)
    release = read_metadata(run.folder.absolute().parents[1])
    tables = release.sensor_tables if release else ()
    drive = []
    for table in (table for table in tables if table.name == DRIVE_TABLE):
        numbers = read_side(run.folder / SIDE / table.file, table, rows)
        for column, values in zip(table.columns[1:], numbers.T[1:], strict=True):
            role = Role.READING if column.name.endswith("_ticks") else Role.INPUT
            series = TimeSeries(column.name, column.unit, 1e-3 * rows.t_ms, values.copy())
            drive.append(Channel.logged(series, role))
    no_target = rows.tof_m == round(spec.robot.tof.no_target_m, RANGES.columns[0].decimals)
    return trial_of(run_name(run.folder), rows, (*drive, *row_channels(rows, no_target, np.zeros_like(no_target))))


IMPORTER = Importer("run", _recognises, _read)
