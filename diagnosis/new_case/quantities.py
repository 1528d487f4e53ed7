"""The quantities of each kind of case, by the words with which logs name them."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from diagnosis.measured.case_files.case_format import COLUMNS, RANGE_SIDES, RANGES, WHEEL_VOLTAGES
from diagnosis.measured.case_files.csv_table import MeasuredColumn
from diagnosis.measured.measurement import CaseKind
from logs.columns.drive import COMMANDS, COUNT_WORDS, PER_ROW, VOLTAGE, WHEELS
from logs.columns.quantity import (
    EAST,
    EPOCH_TIME,
    FILLERS,
    FRONT,
    HEADING,
    LEFT,
    NORTH,
    RANGE,
    RIGHT,
    SENSE,
    SET,
    SIDES,
    SPEED,
    TIME,
    LogKind,
    Quantity,
    words,
)
from logs.units.names import HeaderName, taken_apart
from logs.units.possible_motion import SHORTEST_STEP_S

COLUMN_OPTION = "--column"
"""Option of `symolo case init` for the column of one quantity."""
UNIT_OPTION = "--unit"
"""Option of `symolo case init` for the unit of one quantity."""
STEADY_FROM_S = 0.25
"""Time between two rows from which a log of a motor has one steady state in each row."""
_CURRENT = words("i current cur amps")
_TIMES = (Quantity("t_s", (TIME,)), Quantity("t_s", (EPOCH_TIME,)))
_MOTOR = (
    Quantity("u_cmd_V", (VOLTAGE | SET | words("v"),)),
    Quantity("current_A", (_CURRENT,)),
    Quantity("omega_rad_s", (SPEED,)),
)
_TRIAL = Quantity("trial", (words("trial run experiment"),))

_QUANTITIES: Mapping[CaseKind, tuple[Quantity, ...]] = {
    CaseKind.DRIVE_LOG: (
        _TRIAL,
        *_TIMES,
        *WHEELS,
        Quantity("tof_front_m", (FRONT, RANGE)),
        Quantity("tof_left_m", (LEFT, RANGE)),
        Quantity("tof_right_m", (RIGHT, RANGE)),
        Quantity("x_m", (words("x") | EAST,), unit_suffices=False),
        Quantity("y_m", (words("y") | NORTH,), unit_suffices=False),
        Quantity("theta_rad", (HEADING,), beside=SENSE),
        *COMMANDS,
    ),
    CaseKind.TOF_BENCH: (
        *_TIMES,
        Quantity(
            "distance_m",
            (words("distance dist true actual reference ref target truth real set setpoint known"),),
            unit_suffices=False,
        ),
        Quantity("reading_m", (words("reading range tof measured measurement sensor lidar"),), unit_suffices=False),
        Quantity("material", (words("material target surface object board"),)),
        Quantity("incidence_rad", (words("incidence angle tilt"),)),
        Quantity("temperature_C", (words("temperature temp"),)),
        Quantity("ambient_lux", (words("ambient lux light illuminance"),)),
    ),
    CaseKind.MOTOR_STEP: (_TRIAL, *_TIMES, *_MOTOR),
    CaseKind.MOTOR_STEADY: (Quantity("sweep", (words("sweep trial run"),)), *_TIMES, *_MOTOR),
}

_NEEDED: Mapping[CaseKind, tuple[frozenset[str], ...]] = {
    CaseKind.DRIVE_LOG: (
        frozenset({"t_s", "enc_left_ticks", "enc_right_ticks", "x_m", "y_m", "theta_rad"}),
        frozenset({"t_s", "enc_left_ticks", "enc_right_ticks", "u_left_V", "u_right_V"}),
        *(frozenset({"t_s", "x_m", "y_m", "theta_rad", f"tof_{side}_m"}) for side in RANGE_SIDES),
    ),
    CaseKind.TOF_BENCH: (frozenset({"distance_m", "reading_m"}),),
    CaseKind.MOTOR_STEP: (frozenset({"t_s", "u_cmd_V", "omega_rad_s"}), frozenset({"t_s", "u_cmd_V", "current_A"})),
    CaseKind.MOTOR_STEADY: (frozenset({"u_cmd_V", "omega_rad_s"}), frozenset({"u_cmd_V", "current_A"})),
}
"""Sets of quantities of which a log of a kind must have one, in the order in which the kinds are tried.

Poses stand before voltages: they show more of a drive, and are named first if both are missing."""

_BY_UNIT: Mapping[CaseKind, frozenset[str]] = {
    kind: frozenset({"t_s", "u_cmd_V", "current_A", "omega_rad_s"})
    for kind in (CaseKind.MOTOR_STEP, CaseKind.MOTOR_STEADY)
}
"""Quantities of a motor, each of which has a unit of its own."""

STEP_S: Mapping[CaseKind, tuple[float, float]] = {
    CaseKind.DRIVE_LOG: (SHORTEST_STEP_S, 0.1),
    CaseKind.TOF_BENCH: (1e-3, 60.0),
    CaseKind.MOTOR_STEP: (5e-4, STEADY_FROM_S),
    CaseKind.MOTOR_STEADY: (STEADY_FROM_S, 60.0),
}
"""Shortest and longest usual time between two rows, by which the unit of times without one is guessed."""

_HELD: Mapping[CaseKind, frozenset[str]] = {
    CaseKind.DRIVE_LOG: frozenset(WHEEL_VOLTAGES),
    CaseKind.MOTOR_STEP: frozenset({"u_cmd_V"}),
}
"""Voltages that are held from row to row."""

KINDS: Mapping[CaseKind, LogKind] = MappingProxyType(
    {
        kind: LogKind(
            kind.value,
            _QUANTITIES[kind],
            {column.name: column for column in COLUMNS[kind] if isinstance(column, MeasuredColumn)},
            needed,
            RANGES | ({"distance_m"} if kind is CaseKind.TOF_BENCH else set()),
            by_unit=_BY_UNIT.get(kind, frozenset()),
            held=_HELD.get(kind, frozenset()),
            column_option=COLUMN_OPTION,
            unit_option=UNIT_OPTION,
            step_s=STEP_S[kind],
            lone_range="tof_front_m" if kind is CaseKind.DRIVE_LOG else "",
        )
        for kind, needed in _NEEDED.items()
    }
)
"""Kinds in the order in which they are tried."""


def wheel_columns(names: Sequence[str]) -> list[str]:
    """Return the columns of a log that seem to be counts of encoders, of wheels on any side or with numbers."""
    return [name for name in names if _is_of_wheel(taken_apart(name))]


def _is_of_wheel(header: HeaderName) -> bool:
    names = {word.rstrip("0123456789") or word for word in header.words}
    numbers = {word for word in names if word.isdecimal()}
    sides = SIDES | words("back b rear hind third")
    is_count = bool(names & COUNT_WORDS) or header.unit == "ticks"
    return is_count and not names - COUNT_WORDS - PER_ROW - sides - numbers - FILLERS
