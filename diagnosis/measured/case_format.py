"""The columns of data.csv of each kind of measured case, in the order in which we write them."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.channel import Role
from diagnosis.measured.csv_table import AnyColumn, Column, WordColumn
from diagnosis.measured.measurement import Kind
from diagnosis.measured.scale import Reach

DATA = "data.csv"
HOLDOUT = "holdout"
SPLIT = WordColumn("split", ("fit", HOLDOUT))

NO_TARGET_FROM_M = 8.19
"""The device's codes for "no target", 8190 and 8191 mm."""

_TIME = Reach(-1e3, 1e7)
_COUNT = Reach(-1e12, 1e12)
_VOLTAGE = Reach(-60.0, 60.0)
_RANGE = Reach(-0.1, 8.2)
_PLACE = Reach(-50.0, 50.0)


def _number(name: str, decimals: int = 0) -> Column:
    """A column that orders the rows."""
    return Column(name, "", Role.INPUT, _COUNT, decimals, may_be_empty=False)


def _time(name: str, decimals: int) -> Column:
    return Column(name, "s", Role.INPUT, _TIME, decimals, may_be_empty=False)


def _set(name: str, unit: str, reach: Reach, decimals: int) -> Column:
    """What was set or known and is in every row."""
    return Column(name, unit, Role.INPUT, reach, decimals, may_be_empty=False)


_MOTOR = (
    _set("u_cmd_V", "V", _VOLTAGE, 4),
    Column("current_A", "A", Role.READING, Reach(-50.0, 50.0), 6),
    Column("omega_rad_s", "rad/s", Role.READING, Reach(-1000.0, 1000.0), 5),
)
"""Digits are never fewer than a log of this kind has."""

COLUMNS: Mapping[Kind, tuple[AnyColumn, ...]] = MappingProxyType(
    {
        Kind.MOTOR_STEADY: (_number("row"), _number("sweep"), SPLIT, _time("t_s", 4), *_MOTOR),
        Kind.MOTOR_STEP: (_number("trial"), SPLIT, _time("session_time_s", 4), _time("t_s", 4), *_MOTOR),
        Kind.TOF_BENCH: (
            _number("row"),
            SPLIT,
            _time("t_s", 4),
            _set("distance_m", "m", Reach(0.0, 10.0), 5),
            WordColumn("material", may_be_empty=True),
            Column("incidence_rad", "rad", Role.INPUT, Reach(-1.58, 1.58), 5),
            Column("temperature_C", "degC", Role.INPUT, Reach(-60.0, 150.0), 3),
            Column("ambient_lux", "lx", Role.INPUT, Reach(0.0, 200_000.0), 2),
            Column("reading_m", "m", Role.READING, _RANGE, 5),
        ),
        Kind.DRIVE_LOG: (
            _number("trial"),
            SPLIT,
            _time("session_time_s", 4),
            _time("t_s", 4),
            Column("v_cmd_m_s", "m/s", Role.INPUT, Reach(-5.0, 5.0), 5),
            Column("w_cmd_rad_s", "rad/s", Role.INPUT, Reach(-50.0, 50.0), 5),
            Column("u_left_V", "V", Role.INPUT, _VOLTAGE, 5),
            Column("u_right_V", "V", Role.INPUT, _VOLTAGE, 5),
            Column("enc_left_ticks", "ticks", Role.READING, _COUNT, 0),
            Column("enc_right_ticks", "ticks", Role.READING, _COUNT, 0),
            Column("tof_front_m", "m", Role.READING, _RANGE, 5),
            Column("tof_left_m", "m", Role.READING, _RANGE, 5),
            Column("tof_right_m", "m", Role.READING, _RANGE, 5),
            Column("x_m", "m", Role.READING, _PLACE, 6),
            Column("y_m", "m", Role.READING, _PLACE, 6),
            Column("theta_rad", "rad", Role.READING, Reach(-1e4, 1e4), 6),
        ),
    }
)

_POSE = ("x_m", "y_m", "theta_rad")
_STEPS = ("session_time_s", "t_s")
BLIND: Mapping[Kind, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        Kind.MOTOR_STEADY: {"blind_inputs.csv": ("row", "t_s", "u_cmd_V")},
        Kind.MOTOR_STEP: {"blind_inputs.csv": ("trial", *_STEPS, "u_cmd_V")},
        Kind.TOF_BENCH: {
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
        Kind.DRIVE_LOG: {
            "blind_wheels_inputs.csv": (*_STEPS, "u_left_V", "u_right_V"),
            "blind_pose_inputs.csv": (*_STEPS, "enc_left_ticks", "enc_right_ticks", *_POSE),
            "blind_tof_inputs.csv": (*_STEPS, *_POSE),
        },
    }
)
"""Columns of the inputs of unseen runs, by kind and file; their readings are to be predicted."""

ORDERING = frozenset({"row", "sweep", "trial", "split", "session_time_s", "t_s", "material"})
"""Columns that are no channel: they say which row it is."""

RANGES = frozenset({"reading_m", "tof_front_m", "tof_left_m", "tof_right_m"})
"""Channels in which the device's code for "no target" may stand."""

CAMERA_CHANNELS = frozenset(_POSE)
"""Stamped by the clock of the camera outside that tracks the robot."""


def channel_columns(kind: Kind) -> tuple[Column, ...]:
    """The columns of a kind that are channels."""
    return tuple(c for c in COLUMNS[kind] if isinstance(c, Column) and c.name not in ORDERING)
