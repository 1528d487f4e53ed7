"""Logs of a micromouse with two geared motors, encoders and a bridge (Algernon, opatiny/micromouse).

One file is one log with one header line; its name says what it is of. Times are ms in older files and s in newer ones,
where they have decimals. Speeds of the wheels [rpm], commands from -255 to 255 of the bridge's duty, battery in mV.
Of steady speeds every fourth row is held out. Each wheel has a motor of its own: diagnose one at a time (`of_part`).
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer, first_line
from diagnosis.importers.order import check_increasing
from diagnosis.measured.channel import Channel, Mask, Role
from diagnosis.measured.csv_table import MeasuredColumn, table_of
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.measured.nominal import KnownMotor, Nominal, NominalMotor, PositiveSpread, Spread
from diagnosis.measured.scale import Reach
from diagnosis.usual_tolerances import SHARES
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.text_file import read_text
from symolo.core.table import CsvTable, check_header
from symolo.core.time_series import TimeSeries

FULL_COMMAND = 255.0
RAD_S_PER_RPM = np.pi / 30.0
STALE_FROM_SET = 5
"""From this calibration on, a speed was worked out at each count, so that it stays where no count comes."""
STALE_ROWS = 3
"""So many rows of one speed other than zero, under commands that differ, are one reading said again."""
HELD_OUT = 4
"""Of the rows of steady speeds, one in so many."""

STALL_CURRENT_A, NO_LOAD_CURRENT_A = 0.75, 0.08
NO_LOAD_SPEED_RAD_S = 1100.0 * RAD_S_PER_RPM
"""At 12 V, of the HPCB 12 V micro metal gearmotor 30:1 (Pololu's tables: 0.75 A, 80 mA, 1100 rpm)."""
FRICTION_SHARE = 0.3
"""Tolerance of either friction: the tables tell their sum at one speed, of which half is taken for each."""


def nominal_motor() -> KnownMotor:
    """What the motor's maker prints, at the wheel: R = U / I of the stalled motor, K by what the idling one leaves."""
    resistance_ohm = 12.0 / STALL_CURRENT_A
    constant = (12.0 - resistance_ohm * NO_LOAD_CURRENT_A) / NO_LOAD_SPEED_RAD_S
    half_N_m = 0.5 * constant * NO_LOAD_CURRENT_A
    viscous = half_N_m / NO_LOAD_SPEED_RAD_S
    return KnownMotor(
        motor=NominalMotor(
            winding_resistance_ohm=PositiveSpread(
                value=resistance_ohm, tolerance=SHARES["winding_resistance_ohm"] * resistance_ohm
            ),
            torque_constant_N_m_A=PositiveSpread(value=constant, tolerance=SHARES["torque_constant_N_m_A"] * constant),
            viscous_friction_N_m_s_rad=Spread(value=viscous, tolerance=FRICTION_SHARE * viscous),
            coulomb_friction_N_m=Spread(value=half_N_m, tolerance=FRICTION_SHARE * half_N_m),
            supply_voltage_V=8.4,  # two lithium cells, full
        )
    )


_TIME = MeasuredColumn("time", "", Role.INPUT, Reach(0.0, 1e9), may_be_empty=False)
_COMMAND = Reach(-256.0, 256.0)
_RPM = Reach(-3000.0, 3000.0)
_COUNT = Reach(-1e9, 1e9)
_BATTERY = MeasuredColumn("batteryVoltage", "", Role.READING, Reach(0.0, 30_000.0))


def _set(name: str, reach: Reach) -> MeasuredColumn:
    return MeasuredColumn(name, "", Role.INPUT, reach)


def _read_out(name: str, reach: Reach) -> MeasuredColumn:
    return MeasuredColumn(name, "", Role.READING, reach)


_SPEEDS = (_read_out("leftSpeedRpm", _RPM), _read_out("rightSpeedRpm", _RPM))
_MODES = (_set("leftMode", Reach(0.0, 10.0)), _set("rightMode", Reach(0.0, 10.0)))


@dataclass(frozen=True)
class _Form:
    """One kind of file, by the start of its name."""

    columns: tuple[MeasuredColumn, ...]
    trials: Callable[[CsvTable, Array, int], tuple[Trial, ...]]
    """From the table, its times [s] and the number in the file's name."""
    kind: CaseKind = CaseKind.OTHER
    notes: tuple[str, ...] = ()
    nominal: Callable[[], Nominal] | None = None


def _steady(table: CsvTable, t_s: Array, number: int) -> tuple[Trial, ...]:
    """A trial for each wheel."""
    duty = table.numbers["motorCommand"] / FULL_COMMAND
    battery_V = 1e-3 * table.numbers.get("batteryVoltage", np.full(len(t_s), np.nan))
    return tuple(
        _trial(
            side,
            t_s,
            Channel.logged(TimeSeries("duty", "", t_s, duty), Role.INPUT),
            Channel.logged(TimeSeries("supply_V", "V", t_s, battery_V), Role.INPUT),
            Channel.logged(TimeSeries("u_cmd_V", "V", t_s, duty * battery_V), Role.INPUT),
            Channel.logged(
                TimeSeries("omega_rad_s", "rad/s", t_s, RAD_S_PER_RPM * rpm),
                Role.READING,
                stale=repeated(rpm, STALE_ROWS) if number >= STALE_FROM_SET else None,
            ),
            part=f"{side} wheel",
            holdout=np.arange(len(t_s)) % HELD_OUT == HELD_OUT - 1,
        )
        for side in ("left", "right")
        for rpm in (table.numbers[f"{side}SpeedRpm"],)
    )


def repeated(values: Array, rows: int) -> Mask:
    """Samples (N,) that say the one before again in a run of at least so many, zeros left out."""
    same = np.concatenate([[False], (np.diff(values) == 0.0) & (values[1:] != 0.0)])
    starts = np.flatnonzero(~same)
    lengths = np.diff(np.append(starts, len(values)))
    return same & (np.repeat(lengths, lengths) >= rows)


_NAMES: Mapping[str, tuple[str, str, float]] = {
    "leftEncoder": ("enc_left_ticks", "ticks", 1.0),
    "rightEncoder": ("enc_right_ticks", "ticks", 1.0),
    "leftMode": ("mode_left", "", 1.0),
    "rightMode": ("mode_right", "", 1.0),
    "voltage": ("supply_V", "V", 1e-3),
    "targetSpeed": ("omega_target_rad_s", "rad/s", RAD_S_PER_RPM),
    "leftSpeed": ("omega_left_rad_s", "rad/s", RAD_S_PER_RPM),
    "rightSpeed": ("omega_right_rad_s", "rad/s", RAD_S_PER_RPM),
    "leftCommand": ("duty_left", "", 1.0 / FULL_COMMAND),
    "rightCommand": ("duty_right", "", 1.0 / FULL_COMMAND),
}
"""MeasuredColumn of a file -> channel, its unit, and the factor to it."""


def _as_it_is(form_columns: tuple[MeasuredColumn, ...]) -> Callable[[CsvTable, Array, int], tuple[Trial, ...]]:
    def trials(table: CsvTable, t_s: Array, number: int) -> tuple[Trial, ...]:
        del number
        channels = []
        for column in form_columns[1:]:
            name, unit, factor = _NAMES[column.name]
            channels.append(
                Channel.logged(TimeSeries(name, unit, t_s, factor * table.numbers[column.name]), column.role)
            )
        return (_trial("1", t_s, *channels),)

    return trials


def _trial(name: str, t_s: Array, *channels: Channel, part: str = "", holdout: Mask | None = None) -> Trial:
    return Trial(name, t_s, np.zeros(len(t_s), dtype=bool) if holdout is None else holdout, channels, part=part)


_ENCODERS = (_TIME, _read_out("leftEncoder", _COUNT), _read_out("rightEncoder", _COUNT), *_MODES)
_BATTERIES = (_TIME, _read_out("voltage", Reach(0.0, 30_000.0)), *_MODES)
_PID = (
    _TIME,
    _set("targetSpeed", _RPM),
    _read_out("leftSpeed", _RPM),
    _set("leftCommand", _COMMAND),
    _read_out("rightSpeed", _RPM),
    _set("rightCommand", _COMMAND),
)
FORMS: Mapping[str, _Form] = {
    "wheelSpeedCalibration": _Form(
        (_TIME, _BATTERY, _set("motorCommand", _COMMAND), *_SPEEDS),
        _steady,
        CaseKind.MOTOR_STEADY,
        (
            "not logged: current",
            "the voltage is the duty times the battery's, before any loss in the bridge",
            "every fourth row is held out",
        ),
        nominal_motor,
    ),
    "encoders": _Form(_ENCODERS, _as_it_is(_ENCODERS), notes=("not logged: voltage and duty",)),
    "batteryVoltage": _Form(_BATTERIES, _as_it_is(_BATTERIES)),
    "testPid": _Form(_PID, _as_it_is(_PID), notes=("not logged: voltage of the battery",)),
}
_NAME = re.compile(rf"({'|'.join(FORMS)})(\d+)\.csv")


def _recognises(path: Path) -> bool:
    return _NAME.fullmatch(path.name) is not None and first_line(path).startswith("time,")


def _read(path: Path) -> Measurement:
    named = _NAME.fullmatch(path.name)
    if named is None:
        allowed = f"a file named {', '.join(f'{start}<N>.csv' for start in FORMS)}"
        raise InputError("is none of these logs", where=str(path), allowed=allowed)
    form, number = FORMS[named[1]], int(named[2])
    text = read_text(path)
    header = [name.strip() for name in text.lines[0].split(",")]
    columns = form.columns
    notes = list(form.notes)
    if _BATTERY in columns and _BATTERY.name not in header:  # the first log of this kind has none
        columns = tuple(column for column in columns if column is not _BATTERY)
        notes.append("not logged: voltage of the battery, so that the voltage at the motors is not known")
    check_header(header, [column.name for column in columns], path)
    table = table_of(text, columns, [header.index(column.name) for column in columns], first=1, may_break=True)
    check_increasing(table, "time")
    in_s = "." in text.lines[1].partition(",")[0]
    t_s = table.numbers["time"] * (1.0 if in_s else 1e-3)
    notes.append(f"times taken for {'s' if in_s else 'ms'}")
    if form.nominal is None:
        notes.append("nothing is held out")
    source = MeasurementSource("Algernon micromouse, opatiny/micromouse", (str(path),), "CERN-OHL-P v2")
    trials = form.trials(table, t_s - t_s[0], number)
    nominal = None if form.nominal is None else form.nominal()
    return Measurement(path.stem, form.kind, source, trials, nominal, (*table.notes, *notes))


IMPORTER = Importer(
    "micromouse",
    "Algernon micromouse: wheelSpeedCalibration, encoders, batteryVoltage and testPid logs",
    _recognises,
    _read,
)
