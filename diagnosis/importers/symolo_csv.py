"""A data.csv of a SyMoLo dataset without other files, in a known arena (a measured case)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np

from configs.effects.base import RANDOM_SLOTS, Slot
from diagnosis.importers.base import Importer
from diagnosis.importers.cases.case import case_folder, recognises, scale_note
from diagnosis.importers.cases.log_column import LogColumn
from diagnosis.importers.cases.order import check_increasing
from diagnosis.measured.case_files.case_format import CAMERA_CHANNELS, DATA, POSE
from diagnosis.measured.case_files.csv_table import read_csv
from diagnosis.measured.case_files.nominal import NOMINAL, NominalLog, read_nominal
from diagnosis.measured.case_files.symolo_columns import COLUMN_OF, LINE_READINGS, RANGE_READINGS, SPEEDS
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.holdout import hold_out
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from logs.units.plausible import PlausibleRange
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError, together
from symolo.core.tables.table import CsvTable

RUNS = "runs"
"""Folder with a folder for each of several runs."""
TEN_ROWS = 10
MIN_TURN_RAD = 1.0
"""Turn of a log, from which its columns theta and w can be compared."""

IGNORED_BY_TWIST: Mapping[str, frozenset[Slot]] = MappingProxyType(
    {
        "odometry": frozenset({Slot.ROLLING, Slot.ENCODER, Slot.COUNTING}),
        "truth": frozenset({Slot.CREEP}),
    }
)
"""Slots between the speeds and the poses whose effects no prediction has, by the meaning of v and w."""

_PLACE, _TURN, _SPEED = PlausibleRange(-50.0, 50.0), PlausibleRange(-1e4, 1e4), PlausibleRange(-50.0, 50.0)
_RANGE, _REFLECTANCE = PlausibleRange(-0.1, 50.0), PlausibleRange(-0.5, 1.5)


def _time(name: str) -> LogColumn:
    return LogColumn(
        name,
        "ms",
        Role.INPUT,
        PlausibleRange(-1e3, 1e10),
        0,
        may_be_empty=False,
        channel="t_s",
        channel_unit="s",
        factor=1e-3,
    )


def _reading(channel: str, unit: str, plausible: PlausibleRange) -> LogColumn:
    clock = "camera" if channel in CAMERA_CHANNELS else "log"
    is_heading = channel == "theta_rad"
    name = COLUMN_OF[channel]
    return LogColumn(
        name, unit, Role.READING, plausible, channel=channel, channel_unit=unit, is_wrapped=is_heading, clock=clock
    )


def _whole(name: str) -> LogColumn:
    return LogColumn(
        name, "", Role.INPUT, PlausibleRange(0.0, 1e9), 0, may_be_empty=False, channel=name, channel_unit=""
    )


READINGS = (
    _reading("x_m", "m", _PLACE),
    _reading("y_m", "m", _PLACE),
    _reading("theta_rad", "rad", _TURN),
    _reading("v_m_s", "m/s", _SPEED),
    _reading("w_rad_s", "rad/s", _SPEED),
    *(_reading(channel, "m", _RANGE) for channel in RANGE_READINGS),
    *(_reading(channel, "1", _REFLECTANCE) for channel in LINE_READINGS),
)
COLUMNS = (_time("t"), *READINGS[:3], _whole("state"), *READINGS[3:], _whole("img"))
"""Columns of data.csv, with the channels that they become."""


def _read(path: Path) -> Measurement:
    folder, faults = case_folder(path), FaultList()
    nominal, trials, notes = None, [], []
    with faults.noted():
        nominal = _nominal(folder)
    files = list(_files(folder))
    if not files:
        with faults.noted():
            cure = f"put the data.csv of a dataset there, or several into {RUNS}/<name>/"
            raise InputError(f"there is no {DATA}", where=str(folder), cure=cure)
    for name, file in files:
        with faults.noted():
            table = read_csv(file, COLUMNS, may_lack_columns=True)
            check_increasing(table, "t")
            trials.append(_trial(name, table, nominal))
            notes += table.notes
    if nominal is None:
        faults.check()
    source = MeasurementSource("a SyMoLo data.csv", (*(str(file) for _, file in files), str(folder / NOMINAL)))
    measurement = None
    if len(trials) == len(files) and trials and nominal is not None:
        measurement = Measurement(folder.absolute().name, CaseKind.SYMOLO_CSV, source, tuple(trials), nominal)
        with faults.noted():
            measurement = _held_out(measurement, nominal, str(folder / NOMINAL))
    faults.check()
    assert measurement is not None  # noqa: S101 - else there was a fault
    return replace(measurement, notes=(*notes, *_notes(measurement)))


def _nominal(folder: Path) -> NominalLog:
    if not (folder / NOMINAL).is_file():
        cure = f"write one with kind: {CaseKind.SYMOLO_CSV}, arena, robot and noise"
        raise InputError(f"there is no {NOMINAL}", where=str(folder), cure=cure)
    nominal = read_nominal(folder / NOMINAL)
    if not isinstance(nominal, NominalLog):
        raise InputError("kind", where=str(folder / NOMINAL), got=nominal.kind, allowed=CaseKind.SYMOLO_CSV.value)
    ignored = [effect.name for effect in nominal.robot.effects.in_slots(RANDOM_SLOTS | IGNORED_BY_TWIST[nominal.twist])]
    if ignored:
        raise together(
            [
                InputError(
                    f"robot.effects.{name}: no prediction of a bare log with twist: {nominal.twist} has this effect",
                    where=str(folder / NOMINAL),
                    cure="remove it from the robot of this case; what it does is then a deviation",
                )
                for name in ignored
            ]
        )
    return nominal


def _files(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the name and the data.csv of each run: that of the folder itself, or those in `runs`."""
    if (folder / DATA).is_file():
        yield "1", folder / DATA
        return
    yield from ((file.parent.name, file) for file in sorted((folder / RUNS).glob(f"*/{DATA}")))


def _trial(name: str, table: CsvTable, nominal: NominalLog | None) -> Trial:
    # Drifts are counted from the start of a drive, and the clock of a log may show any time then.
    begins_ms = float(table.numbers["t"][0]) if len(table.numbers["t"]) else 0.0
    t_s = 1e-3 * (table.numbers["t"] - begins_ms)
    channels = [column.read(table, t_s) for column in COLUMNS if column.name != "t"]
    if nominal is not None:
        channels = [_with_noise(channel, nominal) for channel in channels]
    return Trial(name, t_s, np.zeros(len(t_s), dtype=bool), tuple(channels), begins_s=1e-3 * begins_ms)


def _with_noise(channel: Channel, nominal: NominalLog) -> Channel:
    """Return a channel with the noise that the case states, and ranges with the code of the robot for no target."""
    noise = nominal.noise
    stated = {"x_m": noise.pose_xy_m, "y_m": noise.pose_xy_m, "theta_rad": noise.pose_theta_rad}
    stated |= {"v_m_s": noise.v_m_s, "w_rad_s": noise.w_rad_s}
    stated |= dict.fromkeys(RANGE_READINGS, noise.d_m) | dict.fromkeys(LINE_READINGS, noise.line)
    sd = stated.get(channel.name)
    no_target = None
    if channel.name in RANGE_READINGS:
        with np.errstate(invalid="ignore"):
            no_target = channel.values >= nominal.robot.tof.no_target_m
    return Channel.logged(
        channel.series,
        channel.role,
        no_target=no_target,
        noise_sd=None if sd is None else np.full(len(channel.values), sd),
        clock=channel.clock,
    )


def _held_out(measurement: Measurement, nominal: NominalLog, where: str) -> Measurement:
    """Return the measurement with the runs or the rows held out that the case names.

    Raises:
        InputError: It names both, or runs that are not there, or leaves no row to fit.
    """
    from_ms = nominal.holdout_from_ms
    if nominal.holdout and from_ms is not None:
        raise InputError("both holdout and holdout_from_ms", where=where, cure="keep holdout for several runs")
    if from_ms is None:
        return hold_out(measurement, nominal.holdout) if nominal.holdout else measurement
    (trial, *others) = measurement.trials
    if others:
        raise InputError("holdout_from_ms for several runs", where=where, cure="name runs in holdout instead")
    t_ms = np.rint(1e3 * (trial.t_s + (trial.begins_s or 0.0)))
    if not t_ms[0] < from_ms <= t_ms[-1]:
        allowed = f"a time after the first row and up to the last one: {t_ms[0]:.0f} to {t_ms[-1]:.0f} ms"
        raise InputError("holdout_from_ms", where=where, got=from_ms, allowed=allowed)
    return replace(measurement, trials=(replace(trial, holdout=t_ms >= from_ms),))


def _notes(measurement: Measurement) -> Sequence[str]:
    notes = ["not logged: voltages, currents and encoder counts"]
    offered = {n for n in COLUMN_OF if any(channel.is_offered for channel in measurement.across(n))}
    empty = [column for channel, column in COLUMN_OF.items() if channel not in offered]
    notes += [f"not logged: {', '.join(empty)}"] if empty else []
    if not measurement.heldout_rows:
        notes += ["no rows are held out to test the result; name some with holdout or holdout_from_ms in nominal.yaml"]
    travels, turns = np.zeros(2), np.zeros(2)
    for trial in measurement.trials:
        # In half a second, a robot moves much further than the noise of a pose.
        x, y, theta = (np.diff(trial[name].values[::TEN_ROWS]) for name in POSE)
        by_v, by_w = (_integrals(trial[name].values, trial.t_s) for name in SPEEDS)
        travels += np.nansum(np.hypot(x, y)), np.nansum(np.abs(by_v))
        turns += np.nansum(np.abs(theta)), np.nansum(np.abs(by_w))
    with np.errstate(divide="ignore", invalid="ignore"):
        notes += scale_note(float(travels[0] / travels[1]), "x and y", "m", "the distance by v")
        if min(turns) > MIN_TURN_RAD:
            notes += scale_note(float(turns[0] / turns[1]), "theta", "rad", "the turn by w")
    return notes


def _integrals(speed: Array, t_s: Array) -> Array:
    """Return the integral of a speed over each ten rows."""
    steps = np.nan_to_num(speed[1:]) * np.diff(t_s)
    return np.add.reduceat(steps, np.arange(0, len(steps), TEN_ROWS)) if len(steps) else steps


IMPORTER = Importer(CaseKind.SYMOLO_CSV.value, partial(recognises, CaseKind.SYMOLO_CSV), _read)
