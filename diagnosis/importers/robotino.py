"""Motor currents and speeds of a Festo Robotino 2 on several floors, with poses from a camera.

The data are those of BrOleg5/research-wheel-slippage. Columns are separated by semicolons below three header rows:
name, unit, symbol. The robot has three omnidirectional wheels. Results about motors, floor and slip apply to robots
with two wheels as well, kinematics do not. Currents are magnitudes. Positions of the camera are in pixels.
"""

from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.importers.cases.log_column import LogColumn
from diagnosis.importers.cases.order import check_increasing
from diagnosis.measured.case_files.csv_table import MeasuredColumn, table_of
from diagnosis.measured.channel import Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from logs.recognition import first_line, is_folder
from logs.units.plausible import PlausibleRange
from symolo.core.errors import InputError
from symolo.core.files.text_file import read_text
from symolo.core.progress import plural
from symolo.core.tables.table import cells_of, check_header

HEADER_ROWS = 3
_SEPARATOR = ";"


def _column(symbol: str, unit: str, role: Role, limit: float, channel: str) -> LogColumn:
    return LogColumn(symbol, unit, role, PlausibleRange(-limit, limit), channel=channel, channel_unit=unit)


def _camera(symbol: str, unit: str, limit: float, *, channel: str, channel_unit: str, factor: float = 1.0) -> LogColumn:
    return LogColumn(
        symbol,
        unit,
        Role.READING,
        PlausibleRange(-limit, limit),
        channel=channel,
        channel_unit=channel_unit,
        factor=factor,
        is_wrapped=symbol == "ang",
        clock="camera",
    )


_TIME = MeasuredColumn("t", "ms", Role.INPUT, PlausibleRange(0.0, 1e9), may_be_empty=False)
_MOTORS = (
    *(_column(f"m{i}setvel", "rad/s", Role.INPUT, 1000.0, f"motor_{i}_set_rad_s") for i in (1, 2, 3)),
    *(_column(f"m{i}pos", "ticks", Role.READING, 1e9, f"motor_{i}_ticks") for i in (1, 2, 3)),
    *(_column(f"m{i}vel", "rad/s", Role.READING, 1000.0, f"motor_{i}_rad_s") for i in (1, 2, 3)),
    *(_column(f"m{i}cur", "A", Role.READING, 50.0, f"motor_{i}_A") for i in (1, 2, 3)),
)
_ROBOT = (
    _column("xsetspeed", "m/s", Role.INPUT, 5.0, "vx_set_m_s"),
    _column("ysetspeed", "m/s", Role.INPUT, 5.0, "vy_set_m_s"),
    _column("setvel", "rad/s", Role.INPUT, 1000.0, "w_set_rad_s"),
    *_MOTORS,
    _column("xcur", "A", Role.READING, 50.0, "x_axis_A"),
    _column("ycur", "A", Role.READING, 50.0, "y_axis_A"),
    _column("rotcur", "A", Role.READING, 50.0, "turning_A"),
)
_TRACKED = (
    *_ROBOT,
    _camera("xpos", "pix", 1e5, channel="camera_x_px", channel_unit="px"),
    _camera("ypos", "pix", 1e5, channel="camera_y_px", channel_unit="px"),
    _camera("ang", "deg", 1e5, channel="theta_rad", channel_unit="rad", factor=np.pi / 180.0),
    _camera("dx", "mm", 1e4, channel="step_x_m", channel_unit="m", factor=1e-3),
    _camera("dy", "mm", 1e4, channel="step_y_m", channel_unit="m", factor=1e-3),
    _camera("dang", "deg", 720.0, channel="step_theta_rad", channel_unit="rad", factor=np.pi / 180.0),
)
FORMS = (_MOTORS, _ROBOT, _TRACKED)
"""Columns of the three kinds of file, besides the time: motors only, with the robot's commands, and with a camera."""


def _is_log(path: Path) -> bool:
    return path.suffix == ".csv" and first_line(path).startswith("Time;")


def _recognises(path: Path) -> bool:
    return _is_log(path) or (is_folder(path) and any(_is_log(file) for file in path.glob("*.csv")))


def _read(path: Path) -> Measurement:
    files = sorted(file for file in path.glob("*.csv") if _is_log(file)) if is_folder(path) else [path]
    if not files:
        raise InputError("holds no such log", where=str(path), cure="name a file, or a folder of one floor")
    logs = [_log(file) for file in files]
    first, *others = (tuple(channel.name for channel in trial.channels) for trial, _ in logs)
    for file, names in zip(files[1:], others, strict=True):
        if names != first:
            raise InputError("has other columns than the files before", where=str(file), cure="name one file")
    source = MeasurementSource(
        "Robotino 2 on several floors, Tomsk Polytechnic (BrOleg5/research-wheel-slippage)",
        tuple(str(file) for file in files),
        "Apache-2.0",
    )
    notes = [note for _, notes in logs for note in notes]
    notes += ["not logged: voltage", "currents are magnitudes", "nothing is marked as held out"]
    trials = tuple(trial for trial, _ in logs)
    return Measurement(path.absolute().stem, CaseKind.OTHER, source, trials, notes=tuple(dict.fromkeys(notes)))


def _log(path: Path) -> tuple[Trial, tuple[str, ...]]:
    text = read_text(path)
    if len(text.lines) < HEADER_ROWS:
        raise InputError(
            f"has {plural(len(text.lines), 'row')}", where=str(path), allowed="3 header rows: name, unit, symbol"
        )
    _, units, symbols = (cells_of(line.rstrip(_SEPARATOR), _SEPARATOR) for line in text.lines[:HEADER_ROWS])
    form = next((form for form in FORMS if len(form) + 1 == len(symbols)), _TRACKED)
    columns = (_TIME, *form)
    check_header(symbols, [column.name for column in columns], path)
    unit_of = {column.name: column.unit for column in columns}
    for symbol, unit in zip(symbols, units, strict=False):
        if unit != unit_of[symbol]:
            raise InputError(f"unit of column {symbol}", where=f"{path}: row 2", got=unit, allowed=unit_of[symbol])
    places = [symbols.index(column.name) for column in columns]
    table = table_of(text, columns, places, first=HEADER_ROWS, separator=_SEPARATOR)
    check_increasing(table, _TIME.name)
    t_s = 1e-3 * table.numbers[_TIME.name]
    channels = tuple(column.read(table, t_s) for column in form)
    return Trial(path.stem, t_s, np.zeros(len(t_s), dtype=bool), channels), table.notes


IMPORTER = Importer("robotino", _recognises, _read)
