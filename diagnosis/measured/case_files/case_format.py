"""Columns of data.csv for each kind of measured case, in the order in which we write them."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.case_files.csv_table import CaseColumn, MeasuredColumn
from diagnosis.measured.channel import Role
from diagnosis.measured.measurement import CaseKind
from logs.units.plausible import PlausibleRange
from sensors.ranging.range_view import RANGE_SENSORS
from symolo.core.tables.table import WordColumn

DATA = "data.csv"
HOLDOUT = "holdout"
SPLIT = WordColumn("split", ("fit", HOLDOUT))

RANGE_SIDES: tuple[str, ...] = tuple(RANGE_SENSORS.tolist())
"""Range sensors of a drive, in the order of their columns."""

LONG_AFTER_S = 1e6
"""Time after switching on when nothing warms up any more. Rows of a log without times are counted from here on."""
NO_TARGET_FROM_M = 8.19
"""Smallest of the device's codes for "no target", which are 8190 and 8191 mm."""

_TIME = PlausibleRange(-1e3, 1e7)
_COUNT = PlausibleRange(-1e12, 1e12)
_VOLTAGE = PlausibleRange(-60.0, 60.0)
_RANGE = PlausibleRange(-0.1, 8.2)
_PLACE = PlausibleRange(-50.0, 50.0)


def _number(name: str, decimals: int = 0) -> MeasuredColumn:
    """Return a column that orders the rows."""
    return MeasuredColumn(name, "", Role.INPUT, _COUNT, decimals, may_be_empty=False)


def _time(name: str, decimals: int) -> MeasuredColumn:
    return MeasuredColumn(name, "s", Role.INPUT, _TIME, decimals, may_be_empty=False)


def _set(name: str, unit: str, plausible: PlausibleRange, decimals: int) -> MeasuredColumn:
    """Return a column of an input that is known in every row."""
    return MeasuredColumn(name, unit, Role.INPUT, plausible, decimals, may_be_empty=False)


_MOTOR = (
    _set("u_cmd_V", "V", _VOLTAGE, 4),
    MeasuredColumn("current_A", "A", Role.READING, PlausibleRange(-50.0, 50.0), 6),
    MeasuredColumn("omega_rad_s", "rad/s", Role.READING, PlausibleRange(-1000.0, 1000.0), 5),
)
"""Columns of a motor, with at least as many digits as such logs have."""

COLUMNS: Mapping[CaseKind, tuple[CaseColumn, ...]] = MappingProxyType(
    {
        CaseKind.MOTOR_STEADY: (_number("row"), _number("sweep"), SPLIT, _time("t_s", 4), *_MOTOR),
        CaseKind.MOTOR_STEP: (_number("trial"), SPLIT, _time("session_time_s", 4), _time("t_s", 4), *_MOTOR),
        CaseKind.TOF_BENCH: (
            _number("row"),
            SPLIT,
            _time("t_s", 4),
            _set("distance_m", "m", PlausibleRange(0.0, 10.0), 5),
            WordColumn("material", may_be_empty=True),
            MeasuredColumn("incidence_rad", "rad", Role.INPUT, PlausibleRange(-1.58, 1.58), 5),
            MeasuredColumn("temperature_C", "degC", Role.INPUT, PlausibleRange(-60.0, 150.0), 3),
            MeasuredColumn("ambient_lux", "lx", Role.INPUT, PlausibleRange(0.0, 200_000.0), 2),
            MeasuredColumn("reading_m", "m", Role.READING, _RANGE, 5),
        ),
        CaseKind.DRIVE_LOG: (
            _number("trial"),
            SPLIT,
            _time("session_time_s", 4),
            _time("t_s", 4),
            MeasuredColumn("v_cmd_m_s", "m/s", Role.INPUT, PlausibleRange(-5.0, 5.0), 5),
            MeasuredColumn("w_cmd_rad_s", "rad/s", Role.INPUT, PlausibleRange(-50.0, 50.0), 5),
            MeasuredColumn("u_left_V", "V", Role.INPUT, _VOLTAGE, 5),
            MeasuredColumn("u_right_V", "V", Role.INPUT, _VOLTAGE, 5),
            MeasuredColumn("enc_left_ticks", "ticks", Role.READING, _COUNT, 0),
            MeasuredColumn("enc_right_ticks", "ticks", Role.READING, _COUNT, 0),
            *(MeasuredColumn(f"tof_{side}_m", "m", Role.READING, _RANGE, 5) for side in RANGE_SIDES),
            MeasuredColumn("x_m", "m", Role.READING, _PLACE, 6),
            MeasuredColumn("y_m", "m", Role.READING, _PLACE, 6),
            MeasuredColumn("theta_rad", "rad", Role.READING, PlausibleRange(-1e4, 1e4), 6),
        ),
    }
)

VOLTAGES = "voltages.csv"
"""File of a drive with the voltages that change between the rows of data.csv; it may be left out."""
WHEEL_VOLTAGES = ("u_left_V", "u_right_V")
VOLTAGE_COLUMNS = (
    _number("trial"),
    _time("t_s", 6),
    *(MeasuredColumn(name, "V", Role.INPUT, _VOLTAGE, 5) for name in WHEEL_VOLTAGES),
)
"""Columns of that file: each voltage is held from the time of its row to that of the next one with a value."""
POSE = ("x_m", "y_m", "theta_rad")
"""Channels of the pose that a camera tracks."""
_STEPS = ("session_time_s", "t_s")
BLIND: Mapping[CaseKind, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        CaseKind.MOTOR_STEADY: {"blind_inputs.csv": ("row", "t_s", "u_cmd_V")},
        CaseKind.MOTOR_STEP: {"blind_inputs.csv": ("trial", *_STEPS, "u_cmd_V")},
        CaseKind.TOF_BENCH: {
            "blind_inputs.csv": (
                "row",
                "t_s",
                "distance_m",
                "material",
                "incidence_rad",
                "temperature_C",
                "ambient_lux",
            )
        },
        CaseKind.DRIVE_LOG: {
            "blind_wheels_inputs.csv": (*_STEPS, "u_left_V", "u_right_V"),
            "blind_pose_inputs.csv": (*_STEPS, "enc_left_ticks", "enc_right_ticks", *POSE),
            "blind_tof_inputs.csv": (*_STEPS, *POSE),
        },
    }
)
"""Columns of the inputs of unseen runs, by kind and file. The readings of these runs are to be predicted."""

ORDERING = frozenset({"row", "sweep", "trial", "split", "session_time_s", "t_s", "material"})
"""Columns that identify the row and are not channels."""

RANGES = frozenset({"reading_m", *(f"tof_{side}_m" for side in RANGE_SIDES)})
"""Channels that may contain the device's code for "no target"."""

CAMERA_CHANNELS = frozenset(POSE)
"""Channels with the times of the external camera that tracks the robot."""


def channel_columns(kind: CaseKind) -> tuple[MeasuredColumn, ...]:
    """Return the columns of a kind that are channels."""
    return tuple(c for c in COLUMNS[kind] if isinstance(c, MeasuredColumn) and c.name not in ORDERING)
