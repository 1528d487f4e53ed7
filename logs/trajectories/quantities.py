"""The quantities that a table with a trajectory may hold."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from logs.columns.drive import COMMANDS, WHEELS
from logs.columns.quantity import (
    EAST,
    EPOCH_TIME,
    FILLERS,
    FRONT,
    HEADING,
    LEFT,
    LINEAR,
    NORTH,
    RANGE,
    RIGHT,
    SENSE,
    TIME,
    TURNING,
    LogKind,
    Quantity,
    words,
)
from logs.units.plausible import PlausibleRange

READING_OF: Mapping[str, str] = MappingProxyType(
    {
        "v_m_s": "v",
        "w_rad_s": "w",
        "tof_front_m": "d_f",
        "tof_left_m": "d_l",
        "tof_right_m": "d_r",
        **{f"line_{i}": f"L{i}" for i in range(8)},
    }
)
"""Column of data.csv by our name of the quantity."""
DRIVE_QUANTITIES = tuple(quantity.name for quantity in (*COMMANDS, *WHEELS))
"""Quantities of the table `side/drive.csv`."""
QUATERNION = ("qx", "qy", "qz", "qw")


@dataclass(frozen=True)
class _QuantityScale:
    unit: str
    plausible: PlausibleRange


_PLACE = _QuantityScale("m", PlausibleRange(-1e7, 1e7))
_SPEED, _TURN = (
    _QuantityScale("m/s", PlausibleRange(-30.0, 30.0)),
    _QuantityScale("rad/s", PlausibleRange(-100.0, 100.0)),
)
_COUNT, _VOLTAGE = (
    _QuantityScale("ticks", PlausibleRange(-1e12, 1e12)),
    _QuantityScale("V", PlausibleRange(-60.0, 60.0)),
)
_COMPONENT = _QuantityScale("", PlausibleRange(-1.5, 1.5))
_RANGE = _QuantityScale("m", PlausibleRange(-0.1, 100.0))

TRAJECTORY = LogKind(
    "trajectory",
    (
        Quantity("t_s", (TIME,)),
        Quantity("t_s", (EPOCH_TIME,)),
        *COMMANDS,
        *WHEELS,
        Quantity("v_m_s", (LINEAR,)),
        Quantity("w_rad_s", (TURNING - words("yaw ang"),)),
        Quantity("w_rad_s", (words("yaw turn angular ang"), words("rate speed velocity vel"))),
        Quantity("tof_front_m", (FRONT, RANGE)),
        Quantity("tof_left_m", (LEFT, RANGE)),
        Quantity("tof_right_m", (RIGHT, RANGE)),
        *(Quantity(f"line_{i}", (words(f"l{i}"),)) for i in range(8)),
        *(Quantity(f"line_{i}", (words("line qtr"), words(str(i)))) for i in range(8)),
        *(Quantity(name, (words(name),)) for name in QUATERNION),
        *(Quantity(f"q{axis}", (words("q quat quaternion rotation orientation"), words(axis))) for axis in "xyzw"),
        Quantity("x_m", (words("x tx px") | EAST,), unit_suffices=False),
        Quantity("y_m", (words("y ty py") | NORTH,), unit_suffices=False),
        Quantity("z_m", (words("z tz pz"),), unit_suffices=False),
        Quantity("theta_rad", (HEADING,), beside=SENSE),
    ),
    {
        "t_s": _QuantityScale("s", PlausibleRange(-1e12, 1e12)),
        "x_m": _PLACE,
        "y_m": _PLACE,
        "z_m": _PLACE,
        "theta_rad": _QuantityScale("rad", PlausibleRange(-1e5, 1e5)),
        "v_cmd_m_s": _SPEED,
        "w_cmd_rad_s": _TURN,
        "enc_left_ticks": _COUNT,
        "enc_right_ticks": _COUNT,
        "u_left_V": _VOLTAGE,
        "u_right_V": _VOLTAGE,
        "v_m_s": _SPEED,
        "w_rad_s": _TURN,
        "tof_front_m": _RANGE,
        "tof_left_m": _RANGE,
        "tof_right_m": _RANGE,
        **dict.fromkeys(QUATERNION, _COMPONENT),
        **{f"line_{i}": _QuantityScale("", PlausibleRange(0.0, 1.0)) for i in range(8)},
    },
    (
        frozenset({"t_s", "x_m", "y_m", "theta_rad"}),
        frozenset({"t_s", "x_m", "y_m", "z_m", *QUATERNION}),
        frozenset({"t_s", "x_m", "y_m", *QUATERNION}),
        frozenset({"t_s", "x_m", "y_m"}),
    ),
    frozenset({"tof_front_m", "tof_left_m", "tof_right_m"}),
    FILLERS | words("field odom odometry ground truth gt base link body rigid estimate est wheel imu"),
    mapping_option="--map",
    supply_option="as factor of the voltages in a mapping file, with --map",
    page="docs/import.md",
    elsewhere="; of a log without poses, `symolo case init` makes a case",
)
"""Tables of times and poses; headings may be angles or quaternions, or the direction of the path."""
