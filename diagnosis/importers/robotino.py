"""Motor currents and speeds of a Festo Robotino 2 on several floors, with a camera's pose.

The data are those of BrOleg5/research-wheel-slippage. Columns are separated by semicolons below three header rows:
name, unit, symbol. The robot has three omnidirectional wheels: motors, floor and slip carry over to two wheels,
kinematics do not. Currents are magnitudes. Positions of the camera are in pixels; angles count on beyond a turn here.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer, first_line, is_folder
from diagnosis.importers.order import check_increasing
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.csv_table import MeasuredColumn, table_of
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.measured.scale import Reach
from symolo.core.errors import InputError
from symolo.core.files.text_file import TextFile, read_text
from symolo.core.table import check_header
from symolo.core.time_series import TimeSeries

HEADER_ROWS = 3
_SEPARATOR = ";"


@dataclass(frozen=True)
class _Quantity:
    """What stands under a symbol."""

    unit: str
    """In the file."""
    channel: str
    to_unit: str
    factor: float
    role: Role
    reach: Reach
    """In the file's unit."""

    def column(self, symbol: str) -> MeasuredColumn:
        return MeasuredColumn(symbol, self.unit, self.role, self.reach)


def _speed(channel: str, role: Role = Role.INPUT) -> _Quantity:
    return _Quantity("rad/s", channel, "rad/s", 1.0, role, Reach(-1000.0, 1000.0))


def _current(channel: str) -> _Quantity:
    return _Quantity("A", channel, "A", 1.0, Role.READING, Reach(-50.0, 50.0))


def _camera(unit: str, channel: str, to_unit: str, factor: float, reach: float) -> _Quantity:
    return _Quantity(unit, channel, to_unit, factor, Role.READING, Reach(-reach, reach))


_DEGREE = np.pi / 180.0
_MOTORS: Mapping[str, _Quantity] = {
    **{f"m{i}setvel": _speed(f"motor_{i}_set_rad_s") for i in (1, 2, 3)},
    **{
        f"m{i}pos": _Quantity("ticks", f"motor_{i}_ticks", "ticks", 1.0, Role.READING, Reach(-1e9, 1e9))
        for i in (1, 2, 3)
    },
    **{f"m{i}vel": _speed(f"motor_{i}_rad_s", Role.READING) for i in (1, 2, 3)},
    **{f"m{i}cur": _current(f"motor_{i}_A") for i in (1, 2, 3)},
}
_ROBOT: Mapping[str, _Quantity] = {
    "xsetspeed": _Quantity("m/s", "vx_set_m_s", "m/s", 1.0, Role.INPUT, Reach(-5.0, 5.0)),
    "ysetspeed": _Quantity("m/s", "vy_set_m_s", "m/s", 1.0, Role.INPUT, Reach(-5.0, 5.0)),
    "setvel": _speed("w_set_rad_s"),
    **_MOTORS,
    "xcur": _current("x_axis_A"),
    "ycur": _current("y_axis_A"),
    "rotcur": _current("turning_A"),
}
_TRACKED: Mapping[str, _Quantity] = {
    **_ROBOT,
    "xpos": _camera("pix", "camera_x_px", "px", 1.0, 1e5),
    "ypos": _camera("pix", "camera_y_px", "px", 1.0, 1e5),
    "ang": _camera("deg", "theta_rad", "rad", _DEGREE, 1e5),
    "dx": _camera("mm", "step_x_m", "m", 1e-3, 1e4),
    "dy": _camera("mm", "step_y_m", "m", 1e-3, 1e4),
    "dang": _camera("deg", "step_theta_rad", "rad", _DEGREE, 720.0),
}
FORMS = (_MOTORS, _ROBOT, _TRACKED)
"""What files have, beside their time: motors alone, with the robot's commands, with a camera."""
_CAMERA = tuple(name for name in _TRACKED if name not in _ROBOT)
_TIME = MeasuredColumn("t", "ms", Role.INPUT, Reach(0.0, 1e9), may_be_empty=False)


def _is_log(path: Path) -> bool:
    return path.suffix == ".csv" and first_line(path).startswith("Time;")


def _recognises(path: Path) -> bool:
    return _is_log(path) or (is_folder(path) and any(_is_log(file) for file in path.glob("*.csv")))


def _read(path: Path) -> Measurement:
    files = sorted(file for file in path.glob("*.csv") if _is_log(file)) if is_folder(path) else [path]
    if not files:
        raise InputError("holds no such log", where=str(path), cure="name a file, or a folder of one floor")
    read = [_log(file) for file in files]
    first, *others = (tuple(channel.name for channel in trial.channels) for trial, _ in read)
    for file, names in zip(files[1:], others, strict=True):
        if names != first:
            raise InputError("has other columns than the files before", where=str(file), cure="name one file")
    source = MeasurementSource(
        "Robotino 2 on several floors, Tomsk Polytechnic (BrOleg5/research-wheel-slippage)",
        tuple(str(file) for file in files),
        "Apache-2.0",
    )
    notes = [note for _, notes in read for note in notes]
    notes += ["not logged: voltage", "currents are magnitudes", "nothing is marked as held out"]
    trials = tuple(trial for trial, _ in read)
    return Measurement(path.absolute().stem, CaseKind.OTHER, source, trials, notes=tuple(dict.fromkeys(notes)))


def _log(path: Path) -> tuple[Trial, tuple[str, ...]]:
    text = read_text(path)
    if len(text.lines) < HEADER_ROWS:
        raise InputError(f"has {len(text.lines)} rows", where=str(path), allowed="3 header rows: name, unit, symbol")
    _, units, symbols = (_cells(text, row) for row in range(HEADER_ROWS))
    form = next((form for form in FORMS if len(form) + 1 == len(symbols)), _TRACKED)
    check_header(symbols, [_TIME.name, *form], path)
    wanted = {_TIME.name: _TIME.unit, **{symbol: quantity.unit for symbol, quantity in form.items()}}
    for symbol, unit in zip(symbols, units, strict=False):
        if unit != wanted[symbol]:
            raise InputError(f"unit of column {symbol}", where=f"{path}: row 2", got=unit, allowed=wanted[symbol])
    columns = (_TIME, *(quantity.column(symbol) for symbol, quantity in form.items()))
    places = [symbols.index(column.name) for column in columns]
    table = table_of(text, columns, places, first=HEADER_ROWS, separator=_SEPARATOR)
    check_increasing(table, _TIME.name)
    t_s = 1e-3 * table.numbers[_TIME.name]
    channels = []
    for symbol, quantity in form.items():
        values = quantity.factor * table.numbers[symbol]
        if symbol == "ang":
            given = np.isfinite(values)
            values[given] = np.unwrap(values[given])  # one NaN would go on to all later rows
        series = TimeSeries(quantity.channel, quantity.to_unit, t_s, values)
        clock = "camera" if symbol in _CAMERA else "log"
        channels.append(Channel.logged(series, quantity.role, clock=clock))
    return Trial(path.stem, t_s, np.zeros(len(t_s), dtype=bool), tuple(channels)), table.notes


def _cells(text: TextFile, row: int) -> list[str]:
    return [cell.strip() for cell in text.lines[row].rstrip(_SEPARATOR).split(_SEPARATOR)]


IMPORTER = Importer(
    "robotino",
    "Robotino 2: motor currents and speeds on several floors, a log or a folder of one floor",
    _recognises,
    _read,
)
