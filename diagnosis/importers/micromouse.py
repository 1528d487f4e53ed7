"""Logs of a micromouse with two geared motors, encoders and a bridge (Algernon, opatiny/micromouse).

The name of a file states what was logged; its first line is the header. Times are in ms in older files and in s in
newer ones, where they have decimals. Wheel speeds are in rpm, commands are duty cycles of the bridge from -255 to 255,
and the battery is in mV. Every fourth row of steady speeds is held out. Each wheel has its own motor, so the wheels
must be diagnosed one at a time (`select_part`).
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.importers.cases.log_column import LogColumn
from diagnosis.importers.cases.order import check_increasing
from diagnosis.measured.case_files.csv_table import MeasuredColumn, table_of
from diagnosis.measured.case_files.nominal import KnownMotor, NominalMotor, PositiveSpread, Spread
from diagnosis.measured.channel import Channel, Mask, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.usual_tolerances import SHARES
from logs.recognition import first_line
from logs.units.plausible import PlausibleRange
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.text_file import TextFile, read_text
from symolo.core.tables.table import CsvTable, cells_of, check_header
from symolo.core.tables.time_series import TimeSeries

FULL_COMMAND = 255.0
RAD_S_PER_RPM = np.pi / 30.0
STALE_FROM_SET = 5
"""Number of the first calibration whose speeds were updated at encoder counts only, and so are stale without counts."""
STALE_ROWS = 3
"""Number of rows with the same speed other than zero, under different commands, from which the repeats are stale."""
HELD_OUT = 4
"""One of so many rows of steady speeds is held out."""

STALL_CURRENT_A, NO_LOAD_CURRENT_A = 0.75, 0.08
NO_LOAD_SPEED_RAD_S = 1100.0 * RAD_S_PER_RPM
"""Figures at 12 V of the HPCB 12 V micro metal gearmotor 30:1 (Pololu's tables: 0.75 A, 80 mA, 1100 rpm)."""
FRICTION_SHARE = 0.3
"""Tolerance of both frictions, as a share. The tables give only their sum at one speed; each is taken as half of it."""


def nominal_motor() -> KnownMotor:
    """Return the motor of the maker's tables, at the wheel shaft.

    The resistance is U / I of the stalled motor. The torque constant follows from the voltage that the winding leaves
    at no-load speed.
    """
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
            supply_voltage_V=8.4,  # two full lithium cells
        )
    )


def _reading(name: str, plausible: PlausibleRange) -> MeasuredColumn:
    return MeasuredColumn(name, "", Role.READING, plausible)


def _ticks(name: str, channel: str) -> LogColumn:
    return LogColumn(name, "", Role.READING, PlausibleRange(-1e9, 1e9), channel=channel, channel_unit="ticks")


def _speed(name: str, role: Role, channel: str) -> LogColumn:
    return LogColumn(name, "", role, RPM, channel=channel, channel_unit="rad/s", factor=RAD_S_PER_RPM)


def _command(name: str, channel: str) -> LogColumn:
    return LogColumn(name, "", Role.INPUT, COMMAND, channel=channel, channel_unit="", factor=1.0 / FULL_COMMAND)


def _mode(name: str, channel: str) -> LogColumn:
    return LogColumn(name, "", Role.INPUT, PlausibleRange(0.0, 10.0), channel=channel, channel_unit="")


RPM = PlausibleRange(-3000.0, 3000.0)
COMMAND = PlausibleRange(-256.0, 256.0)
BATTERY_MV = PlausibleRange(0.0, 30_000.0)
TIME = MeasuredColumn("time", "", Role.INPUT, PlausibleRange(0.0, 1e9), may_be_empty=False)
STEADY = "wheelSpeedCalibration"
BATTERY = _reading("batteryVoltage", BATTERY_MV)
STEADY_COLUMNS = (
    TIME,
    BATTERY,
    MeasuredColumn("motorCommand", "", Role.INPUT, COMMAND),
    _reading("leftSpeedRpm", RPM),
    _reading("rightSpeedRpm", RPM),
)
STEADY_NOTES = (
    "not logged: current",
    "the voltage is the duty times the battery's, before any loss in the bridge",
    "every fourth row is held out",
)
_MODES = (_mode("leftMode", "mode_left"), _mode("rightMode", "mode_right"))
OTHER_COLUMNS: Mapping[str, tuple[LogColumn, ...]] = {
    "encoders": (_ticks("leftEncoder", "enc_left_ticks"), _ticks("rightEncoder", "enc_right_ticks"), *_MODES),
    "batteryVoltage": (
        LogColumn("voltage", "", Role.READING, BATTERY_MV, channel="supply_V", channel_unit="V", factor=1e-3),
        *_MODES,
    ),
    "testPid": (
        _speed("targetSpeed", Role.INPUT, "omega_target_rad_s"),
        _speed("leftSpeed", Role.READING, "omega_left_rad_s"),
        _command("leftCommand", "duty_left"),
        _speed("rightSpeed", Role.READING, "omega_right_rad_s"),
        _command("rightCommand", "duty_right"),
    ),
}
"""Columns besides the time, by the start of a file's name."""
OTHER_NOTES = {"encoders": ("not logged: voltage and duty",), "testPid": ("not logged: voltage of the battery",)}
STARTS = (STEADY, *OTHER_COLUMNS)
_NAME = re.compile(rf"({'|'.join(STARTS)})(\d+)\.csv")


def _recognises(path: Path) -> bool:
    return _NAME.fullmatch(path.name) is not None and first_line(path).startswith("time,")


def _read(path: Path) -> Measurement:
    named = _NAME.fullmatch(path.name)
    if named is None:
        allowed = f"a file named {', '.join(f'{start}<N>.csv' for start in STARTS)}"
        raise InputError("is none of these logs", where=str(path), allowed=allowed)
    source = MeasurementSource("Algernon micromouse, opatiny/micromouse", (str(path),), "CERN-OHL-P v2")
    start, text = named[1], read_text(path)
    if start == STEADY:
        columns, notes = STEADY_COLUMNS, [*STEADY_NOTES]
        if BATTERY.name not in cells_of(text.lines[0]):  # the first log of this kind has no such column
            columns = tuple(column for column in columns if column is not BATTERY)
            notes.append("not logged: voltage of the battery, so that the voltage at the motors is not known")
        table, t_s, unit = _table(text, columns)
        notes.append(f"times taken for {unit}")
        trials = _wheels(table, t_s, int(named[2]))
        return Measurement(path.stem, CaseKind.MOTOR_STEADY, source, trials, nominal_motor(), (*table.notes, *notes))
    table, t_s, unit = _table(text, (TIME, *OTHER_COLUMNS[start]))
    notes = (*table.notes, *OTHER_NOTES.get(start, ()), f"times taken for {unit}", "nothing is held out")
    channels = tuple(column.read(table, t_s) for column in OTHER_COLUMNS[start])
    trial = Trial("1", t_s, np.zeros(len(t_s), dtype=bool), channels)
    return Measurement(path.stem, CaseKind.OTHER, source, (trial,), notes=notes)


def _table(text: TextFile, columns: Sequence[MeasuredColumn]) -> tuple[CsvTable, Array, str]:
    """Return the table of a log, its times [s] since the first row (N,), and the unit of the times in the file."""
    header = cells_of(text.lines[0])
    check_header(header, [column.name for column in columns], text.path)
    table = table_of(text, columns, [header.index(column.name) for column in columns], first=1, may_break=True)
    check_increasing(table, TIME.name)
    unit = "s" if "." in text.lines[1].partition(",")[0] else "ms"
    t_s = table.numbers[TIME.name] * (1.0 if unit == "s" else 1e-3)
    return table, t_s - t_s[0], unit


def _wheels(table: CsvTable, t_s: Array, number: int) -> tuple[Trial, ...]:
    """Return a trial for each wheel; both have the same duty cycle and voltage."""
    duty = table.numbers["motorCommand"] / FULL_COMMAND
    battery_V = 1e-3 * table.numbers.get(BATTERY.name, np.full(len(t_s), np.nan))
    holdout = np.arange(len(t_s)) % HELD_OUT == HELD_OUT - 1
    inputs = tuple(
        Channel.logged(TimeSeries(name, unit, t_s, values), Role.INPUT)
        for name, unit, values in (
            ("duty", "", duty),
            ("supply_V", "V", battery_V),
            ("u_cmd_V", "V", duty * battery_V),
        )
    )
    trials = []
    for side in ("left", "right"):
        rpm = table.numbers[f"{side}SpeedRpm"]
        series = TimeSeries("omega_rad_s", "rad/s", t_s, RAD_S_PER_RPM * rpm)
        stale = repeated(rpm, STALE_ROWS) if number >= STALE_FROM_SET else None
        speed = Channel.logged(series, Role.READING, stale=stale)
        trials.append(Trial(side, t_s, holdout, (*inputs, speed), part=f"{side} wheel"))
    return tuple(trials)


def repeated(values: Array, rows: int) -> Mask:
    """Return which samples (N,) repeat the previous one in a run of at least `rows` equal values other than zero."""
    same = np.concatenate([[False], (np.diff(values) == 0.0) & (values[1:] != 0.0)])
    starts = np.flatnonzero(~same)
    lengths = np.diff(np.append(starts, len(values)))
    return same & (np.repeat(lengths, lengths) >= rows)


IMPORTER = Importer("micromouse", _recognises, _read)
