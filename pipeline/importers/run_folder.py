"""Runs of our own datasets: one run folder, or all runs of a release, as if a robot had logged them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from configs.errors import InputError
from diagnosis.importers.base import Importer, is_file
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import Kind, Measurement, Source, Trial
from physics.trajectory import TimeSeries
from pipeline.dataset.metadata import METADATA
from pipeline.dataset.rows import Floats, Rows, parse_table, read_rows
from pipeline.dataset.side import TOF, WHEELS, SideTable
from pipeline.importers.data_csv import row_channels, trial_of
from pipeline.stages.assemble import DATA, SIDE
from sensors.tof import TofStatus

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
"""Channel -> its column, whose rows speak of the time since the row before; a channel's of the time to the next one."""
_NOTE = (
    "a voltage is the mean from its row to the next, between which the wheel loop changes it; it drives a motor to the "
    "same place as the loop does but for its ripple"
)


def _runs(path: Path) -> Iterator[Path]:
    """Run folders: the path itself, that of its data.csv, or all below a release."""
    if path.name == DATA:
        path = path.parent
    if is_file(path / DATA) and is_file(path / SIDE / WHEELS.file):
        yield path
    elif is_file(path / METADATA):
        yield from sorted(folder.parent for folder in path.glob(f"*/*/{SIDE}") if is_file(folder.parent / DATA))


def _recognises(path: Path) -> bool:
    return next(_runs(path), None) is not None


def _read(path: Path) -> Measurement:
    runs = list(_runs(path))
    if not runs:
        raise InputError(
            "is no run of a dataset", where=str(path), cure="name a folder such as OUT/CW/test_1, or a release"
        )
    trials = tuple(_trial(run) for run in runs)
    files = tuple(str(run / file) for run in runs for file in (DATA, f"{SIDE}/{WHEELS.file}", f"{SIDE}/{TOF.file}"))
    notes = (_NOTE, "nothing is marked as held out")
    name = path.absolute().parent.name if path.name == DATA else path.absolute().name
    return Measurement(name, Kind.DRIVE_LOG, Source("a dataset of symolo", files), trials, notes=notes)


def _trial(run: Path) -> Trial:
    rows = read_rows(run / DATA)
    wheels, tof = _side(run, WHEELS, rows), _side(run, TOF, rows)
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
    return trial_of(f"{run.absolute().parent.name}/{run.absolute().name}", rows, (*drive, *seen))


def _side(run: Path, table: SideTable, rows: Rows) -> Floats:
    """The numbers of a side table, at the rows of data.csv.

    Raises:
        InputError: It is missing, of another form, or at other times.
    """
    path = run / SIDE / table.file
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path), cure="make the run again") from None
    numbers, faults = parse_table(data, table.header)
    if faults:
        raise InputError(faults[0].what, where=f"{path}: row {faults[0].line}", cure="mend or remove the row")
    if not np.array_equal(numbers[:, 0], rows.t_ms):
        raise InputError(f"column t is not that of {DATA}", where=str(path), cure="make the run again")
    return numbers


IMPORTER = Importer("run", "run folder of a dataset of symolo, or a whole release", _recognises, _read)
