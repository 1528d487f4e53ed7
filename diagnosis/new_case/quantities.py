"""The quantities of a case, and the words by which logs name them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from diagnosis.measured.case_format import COLUMNS, RANGE_SIDES
from diagnosis.measured.csv_table import MeasuredColumn
from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.units import HeaderName, taken_apart, units_for


def _any(text: str) -> frozenset[str]:
    return frozenset(text.split())


_FILLERS = _any(
    "wheel wheels sensor log logged raw meas measured robot mocap opti optitrack vicon camera cam tracker true world "
    "pose pos position mean value motor mot total abs vl53l0x vl53"
)
"""Words that say nothing about which quantity it is."""
_LEFT, _RIGHT = _any("left l lhs links"), _any("right r rhs rechts")
_FRONT = _any("front f fwd forward centre center middle")
_TIME = _any("t time timestamp stamp clock")
DUTY = _any("pwm duty")
"""Words for a voltage as a share of the supply's."""
_VOLTAGE = _any("u voltage volt volts motor mot vm umot") | DUTY
_COUNTS = _any("enc encoder encoders ticks tick counts count cnt pulses steps denc dticks dcounts dcount dcnt")
PER_ROW = _any("delta deltas diff inc increment increments change denc dticks dcounts dcount dcnt")
"""Words for counts since the row before."""
COUNTS = ("enc_left_ticks", "enc_right_ticks")
_RANGE = _any("tof range ranges dist distance d lidar ir sonar ultrasonic")
_HEADING = _any("theta th heading yaw phi angle orientation rotation psi compass")
_SPEED = _any("omega w speed velocity vel rotation")
_SET = _any("cmd command commanded set setpoint target ref reference desired")
_CURRENT = _any("i current cur amps")


@dataclass(frozen=True)
class Quantity:
    name: str
    """Column of data.csv."""
    groups: tuple[frozenset[str], ...]
    """Groups of words, of each of which the name has one."""
    kinds: frozenset[CaseKind]
    unit_suffices: bool = True
    """Whether a unit of the quantity may stand for the last group."""
    beside: frozenset[str] = frozenset()
    """Words that may stand beside those of the groups."""

    def matches(self, header: HeaderName, unit: str) -> bool:
        """Return whether a name means this quantity, whose unit in data.csv is `unit`."""
        words = set(header.words)
        has_unit = header.unit in units_for(unit) if header.unit else False
        if header.unit and not has_unit:
            return False
        *first, last = self.groups
        if not all(words & group for group in first) or not (words & last or (has_unit and self.unit_suffices)):
            return False
        return not words - frozenset.union(*self.groups, self.beside) - _FILLERS


DRIVE, STEP, STEADY, BENCH = CaseKind.DRIVE_LOG, CaseKind.MOTOR_STEP, CaseKind.MOTOR_STEADY, CaseKind.TOF_BENCH
_ALL = frozenset({DRIVE, STEP, STEADY, BENCH})
_MOTORS = frozenset({STEP, STEADY})
_DRIVES = frozenset({DRIVE})
_BENCHES = frozenset({BENCH})

QUANTITIES: tuple[Quantity, ...] = (
    Quantity("trial", (_any("trial run experiment"),), frozenset({DRIVE, STEP})),
    Quantity("sweep", (_any("sweep trial run"),), frozenset({STEADY})),
    Quantity("t_s", (_TIME,), _ALL),
    Quantity("enc_left_ticks", (_LEFT, _COUNTS), _DRIVES, beside=PER_ROW),
    Quantity("enc_right_ticks", (_RIGHT, _COUNTS), _DRIVES, beside=PER_ROW),
    Quantity("u_left_V", (_LEFT, _VOLTAGE), _DRIVES),
    Quantity("u_right_V", (_RIGHT, _VOLTAGE), _DRIVES),
    Quantity("tof_front_m", (_FRONT, _RANGE), _DRIVES),
    Quantity("tof_left_m", (_LEFT, _RANGE), _DRIVES),
    Quantity("tof_right_m", (_RIGHT, _RANGE), _DRIVES),
    Quantity("x_m", (_any("x"),), _DRIVES, unit_suffices=False),
    Quantity("y_m", (_any("y"),), _DRIVES, unit_suffices=False),
    Quantity("theta_rad", (_HEADING,), _DRIVES),
    Quantity("v_cmd_m_s", (_SET, _any("v speed velocity linear lin")), _DRIVES),
    Quantity("w_cmd_rad_s", (_SET, _any("w omega yaw turn angular ang")), _DRIVES),
    Quantity("u_cmd_V", (_VOLTAGE | _SET | _any("v"),), _MOTORS),
    Quantity("current_A", (_CURRENT,), _MOTORS),
    Quantity("omega_rad_s", (_SPEED,), _MOTORS),
    Quantity(
        "distance_m",
        (_any("distance dist true actual reference ref target truth real set setpoint known"),),
        _BENCHES,
        unit_suffices=False,
    ),
    Quantity(
        "reading_m", (_any("reading range tof measured measurement sensor lidar"),), _BENCHES, unit_suffices=False
    ),
    Quantity("material", (_any("material target surface object board"),), _BENCHES),
    Quantity("incidence_rad", (_any("incidence angle tilt"),), _BENCHES),
    Quantity("temperature_C", (_any("temperature temp"),), _BENCHES),
    Quantity("ambient_lux", (_any("ambient lux light illuminance"),), _BENCHES),
)
"""Quantities in the order in which they are tried."""

NEEDED: Mapping[CaseKind, tuple[frozenset[str], ...]] = {
    DRIVE: (
        frozenset({"t_s", "enc_left_ticks", "enc_right_ticks", "u_left_V", "u_right_V"}),
        frozenset({"t_s", "enc_left_ticks", "enc_right_ticks", "x_m", "y_m", "theta_rad"}),
        *(frozenset({"t_s", "x_m", "y_m", "theta_rad", f"tof_{side}_m"}) for side in RANGE_SIDES),
    ),
    BENCH: (frozenset({"distance_m", "reading_m"}),),
    STEP: (frozenset({"t_s", "u_cmd_V", "omega_rad_s"}), frozenset({"t_s", "u_cmd_V", "current_A"})),
    STEADY: (frozenset({"u_cmd_V", "omega_rad_s"}), frozenset({"u_cmd_V", "current_A"})),
}
"""Sets of quantities of which a log of a kind must have one, in the order in which the kinds are tried."""


def quantity_names(kind: CaseKind) -> tuple[str, ...]:
    """Return the columns of data.csv of a kind that can come from a log."""
    return tuple(quantity.name for quantity in QUANTITIES if kind in quantity.kinds)


def our_columns(kind: CaseKind) -> dict[str, MeasuredColumn]:
    """Return the columns of numbers of a kind by name."""
    return {column.name: column for column in COLUMNS[kind] if isinstance(column, MeasuredColumn)}


def matched(kind: CaseKind, names: Sequence[str]) -> dict[str, str]:
    """Return the columns of a log by the quantity that they seem to hold; each is used at most once."""
    columns_of = {quantity: next(iter(columns)) for quantity, columns in _candidates(kind, names) if columns}
    if kind is CaseKind.DRIVE_LOG and not any(f"tof_{side}_m" in columns_of for side in RANGE_SIDES):
        ranges = [name for name in names if name not in columns_of.values() and _is_range(taken_apart(name))]
        if len(ranges) == 1:
            columns_of |= {"tof_front_m": ranges[0]}
    return columns_of


def sides_of(name: str) -> frozenset[str]:
    """Return the words of a name that say on which side something is."""
    return (_LEFT | _RIGHT | _FRONT) & set(taken_apart(name).words)


def of_wheels(names: Sequence[str]) -> list[str]:
    """Return the columns of a log that seem to be counts of encoders, of wheels on any side or with numbers."""
    return [name for name in names if _is_of_wheel(taken_apart(name))]


def _is_range(header: HeaderName) -> bool:
    """Return whether a name is that of a range sensor without a side."""
    words = set(header.words)
    return bool(words & _RANGE) and not words - _RANGE - _FILLERS and header.unit in {"", *units_for("m")}


def _is_of_wheel(header: HeaderName) -> bool:
    words = {word.rstrip("0123456789") or word for word in header.words}
    numbers = {word for word in words if word.isdecimal()}
    sides = _LEFT | _RIGHT | _FRONT | _any("back b rear hind third")
    is_count = bool(words & _COUNTS) or header.unit == "ticks"
    return is_count and not words - _COUNTS - PER_ROW - sides - numbers - _FILLERS


def _candidates(kind: CaseKind, names: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    ours, used = our_columns(kind), set()
    for quantity in QUANTITIES:
        if kind not in quantity.kinds:
            continue
        unit = ours[quantity.name].unit if quantity.name in ours else ""
        free = [name for name in names if name not in used]
        columns = [name for name in free if name == quantity.name] or [
            name for name in free if quantity.matches(taken_apart(name), unit)
        ]
        used |= set(columns[:1])
        yield quantity.name, columns
