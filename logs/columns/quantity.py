"""Quantities of logs, and the words by which the columns of logs name them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import numpy as np

from logs.columns.combined import quaternion_columns, stamp_columns
from logs.units.names import HeaderName, taken_apart, units_for
from logs.units.plausible import PlausibleRange


def words(text: str) -> frozenset[str]:
    """Return a group of words, of which the name of a column has one."""
    return frozenset(text.split())


FILLERS = words(
    "wheel wheels sensor log logged raw meas measured robot mocap opti optitrack vicon camera cam tracker true world "
    "pose pos position field mean value motor mot total abs vl53l0x vl53"
)
"""Words that do not show which quantity it is."""
LEFT, RIGHT = words("left l lhs links gauche izquierda izq"), words("right r rhs rechts droite droit derecha")
FRONT = words("front f fwd forward centre center middle")
SIDES = LEFT | RIGHT | FRONT
TIME = words("t time timestamp stamp clock uptime zeit zeitstempel temps tiempo")
EPOCH_TIME = TIME | words("epoch unix")
"""Words of a time since 1970, too, which often has whole seconds, so that any other clock comes before it."""
SUPPLY = words(
    "battery bat batt vbat vbatt ubat ubatt batterie batteriespannung akku accu lipo supply vcc vdd vin bus versorgung"
)
"""Words for a voltage that is not that of a motor."""
DUTY = words("pwm duty throttle")
"""Words for a voltage as a share of the supply's."""
RANGE = words("tof range ranges dist distance d lidar ir sonar ultrasonic abstand entfernung")
EAST, NORTH = words("east easting"), words("north northing")
HEADING = words("theta th heading hdg yaw phi angle orientation rotation psi compass azimuth bearing winkel gierwinkel")
CLOCKWISE = words("cw clockwise")
SENSE = CLOCKWISE | words("ccw counter anti counterclockwise anticlockwise")
"""Words for the sense in which a heading is counted."""
SPEED = words("omega w speed velocity vel rotation")
SET = words("cmd command commanded set setpoint target ref reference desired")
LINEAR = words("v speed velocity linear lin")
TURNING = words("w omega yaw turn angular ang")


@dataclass(frozen=True)
class Quantity:
    """A quantity of a log, with the words that recognise its column."""

    name: str
    """Name of the quantity in this project, with its unit."""
    groups: tuple[frozenset[str], ...]
    """Groups of words, of each of which the name has one."""
    unit_suffices: bool = True
    """Whether a unit of the quantity may stand for the last group."""
    beside: frozenset[str] = frozenset()
    """Words that may stand beside those of the groups."""

    def matches(self, header: HeaderName, unit: str, fillers: frozenset[str]) -> bool:
        """Return whether a name means this quantity, which we measure in `unit`; it may have `fillers`."""
        names = set(header.words)
        has_unit = header.unit in units_for(unit) if header.unit else False
        if header.unit and not has_unit:
            return False
        *first, last = self.groups
        if not all(names & group for group in first) or not (names & last or (has_unit and self.unit_suffices)):
            return False
        return not names - frozenset.union(*self.groups, self.beside) - fillers


class QuantityScale(Protocol):
    """Unit and possible values of a quantity."""

    @property
    def unit(self) -> str: ...
    @property
    def plausible(self) -> PlausibleRange: ...


@dataclass(frozen=True)
class LogKind:
    """The quantities that a log of one kind may hold."""

    name: str
    quantities: tuple[Quantity, ...]
    """Quantities in the order in which they are looked for; one may occur again with other words."""
    scales: Mapping[str, QuantityScale]
    """Unit and possible values of each quantity that is a number, by its name."""
    needed: tuple[frozenset[str], ...]
    """Sets of quantities, one of which must be complete."""
    ranges: frozenset[str] = frozenset()
    """Readings of range sensors, which small robots log in millimetres."""
    fillers: frozenset[str] = FILLERS
    """Words that do not show which quantity it is."""
    lone_range: str = ""
    """Reading that a single range sensor without a side has, if there is one of this kind."""
    mapping_option: str = "--mapping"
    """Option of the command that reads such logs, with which a user names a mapping file."""
    column_option: str = ""
    """Option with which a user names the column of one quantity; empty if the command has none."""
    unit_option: str = ""
    """Option with which a user states the unit of one quantity; empty if the command has none."""
    step_s: tuple[float, float] = (0.0, np.inf)
    """Shortest and longest usual time between two rows."""
    supply_option: str = "with --set supply_voltage_V=NUMBER"
    """Words for how a user states the voltage of a full duty cycle."""
    page: str = "docs/case_from_log.md"
    """Page on mapping files."""
    elsewhere: str = ""
    """What else to do with a log that lacks these quantities, as the end of a sentence."""
    by_unit: frozenset[str] = frozenset()
    """Quantities that a column with an unknown name may hold if it alone has a unit of the quantity."""
    held: frozenset[str] = frozenset()
    """Voltages of which a mapping may state whether they are held from their row or until it."""

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(quantity.name for quantity in self.quantities))

    def suffices(self, names: Mapping[str, object]) -> bool:
        """Return whether one of the sets of needed quantities is complete."""
        return any(needed <= set(names) for needed in self.needed)

    def unit_of(self, name: str) -> str:
        """Return the unit of a quantity; empty if it has none or is a word."""
        return self.scales[name].unit if name in self.scales else ""

    def matched(self, columns: Sequence[str], chosen: Mapping[str, str] = MappingProxyType({})) -> dict[str, str]:
        """Return the columns of a log by the quantity that they seem to hold; each is used at most once.

        Args:
            columns: Names of the columns.
            chosen: Columns that the user chose, by quantity; those of quantities of other kinds do not count.
        """
        result = {name: name for name in self.names if name in columns and name not in chosen.values()}
        result |= {name: column for name, column in chosen.items() if name in self.names}
        for quantity in self.quantities:
            if quantity.name in result:
                continue
            unit, used = self.unit_of(quantity.name), set(result.values())
            for column in columns:
                if column not in used and quantity.matches(taken_apart(column), unit, self.fillers):
                    result[quantity.name] = column
                    break
        self._combine(columns, result)
        result |= self._by_unit_alone(columns, result)
        if self.lone_range and not self.ranges & result.keys():
            ranges = [name for name in columns if name not in result.values() and self._is_range(taken_apart(name))]
            result |= {self.lone_range: ranges[0]} if len(ranges) == 1 else {}
        return {name: result[name] for name in self.names if name in result}

    def is_by_unit(self, name: str, column: str) -> bool:
        """Return whether a column was taken for a quantity by its unit alone."""
        header, unit = taken_apart(column), self.unit_of(name)
        named = (quantity for quantity in self.quantities if quantity.name == name)
        return (
            name in self.by_unit
            and column != name
            and not any(quantity.matches(header, unit, self.fillers) for quantity in named)
        )

    def _combine(self, columns: Sequence[str], result: dict[str, str]) -> None:
        """Add a time of seconds and parts of one, and a heading by a quaternion, with the first of their columns."""
        stamp = tuple(stamp_columns(columns, self.fillers).values())
        if stamp and "t_s" in self.names and result.get("t_s", stamp[1]) in stamp:
            result["t_s"] = stamp[0]
        components = [name for name in ("qx", "qy", "qz", "qw") if name in result]
        quaternion = quaternion_columns(columns, self.fillers)
        if quaternion and "theta_rad" in self.names and "theta_rad" not in result and len(components) < 4:
            for name in components:
                del result[name]
            result["theta_rad"] = quaternion[0]

    def _by_unit_alone(self, columns: Sequence[str], named: Mapping[str, str]) -> dict[str, str]:
        """Return the columns whose names are unknown, such as `Drehzahl [1/min]`, by the quantity of their unit."""
        headers = {column: taken_apart(column) for column in columns if column not in named.values()}
        result: dict[str, str] = {}
        for name in sorted(self.by_unit - named.keys()):
            units = units_for(self.unit_of(name))
            fitting = [
                column
                for column, header in headers.items()
                if header.unit in units and header.words and not SUPPLY & {*header.words}
            ]
            result |= {name: fitting[0]} if len(fitting) == 1 else {}
        return result

    def _is_range(self, header: HeaderName) -> bool:
        """Return whether a name is that of a range sensor without a side."""
        names = set(header.words)
        return bool(names & RANGE) and not names - RANGE - self.fillers and header.unit in {"", *units_for("m")}
