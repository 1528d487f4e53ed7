"""Names of units in the headers of logs, and their factors to our units."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from logs.plausible_units import OTHER_UNITS
from symolo.core.errors import InputError, nearest

_SPELLINGS: Mapping[str, tuple[str, ...]] = {
    "m": ("m", "meter", "meters", "metre", "metres"),
    "cm": ("cm",),
    "mm": ("mm", "millimeter", "millimeters", "millimetre", "millimetres"),
    "rad": ("rad", "radian", "radians"),
    "degrees": ("deg", "degree", "degrees", "°", "grad"),
    "s": ("s", "sec", "secs", "second", "seconds"),
    "ms": ("ms", "msec", "millis", "milliseconds"),
    "us": ("us", "µs", "usec", "micros", "microseconds"),
    "ns": ("ns", "nsec", "nanoseconds"),
    "V": ("v", "volt", "volts"),
    "mV": ("mv", "millivolt", "millivolts"),
    "A": ("a", "amp", "amps", "ampere"),
    "mA": ("ma", "milliamp", "milliamps"),
    "m/s": ("m/s", "m_s", "mps"),
    "cm/s": ("cm/s", "cm_s"),
    "mm/s": ("mm/s", "mm_s"),
    "rad/s": ("rad/s", "rad_s", "rads"),
    "degrees per second": ("deg/s", "deg_s", "°/s", "dps"),
    "rpm": ("rpm", "rev/min", "r/min", "u/min", "1/min", "min-1", "min^-1"),
    "ticks": ("ticks", "tick", "counts", "count", "cnt", "pulses", "steps"),
    "degC": ("degc", "°c", "celsius", "c"),
    "lx": ("lx", "lux"),
    "percent": ("percent", "pct", "%"),
}
PERCENT = "percent"
"""Unit of a duty cycle; the voltage of a full one is the factor besides the unit."""
_BY_SPELLING = {spelling: unit for unit, spellings in _SPELLINGS.items() for spelling in spellings}
_ALONE = frozenset({"ms", "us", "millis", "micros", "rpm", "seconds", "milliseconds", "microseconds"})
"""Spellings that are a unit even if the name of a column has no other word."""
_BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
NO_UNIT = frozenset({"1", "-", "[1]", "[-]", "(1)", "(-)"})
"""Ways to write in a row of units that a quantity has none."""
_OF_COUNT = frozenset({"enc", "encoder", "encoders"})
"""Words of counts, beside the spellings of ticks: behind them, [1] means no unit and not the first of several."""
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


@dataclass(frozen=True)
class HeaderName:
    """The name of a column, taken apart."""

    words: tuple[str, ...]
    """Lower-case words without the unit."""
    unit: str
    """Unit that the name states, such as `mm` or `degrees`; empty if it states none."""


def taken_apart(name: str) -> HeaderName:
    """Return words and unit of a name such as `x [mm]`, `heading_deg`, `timeMs` or `motor_left (V)`."""
    match = _BRACKETS.match(name)
    if match and (unit := _BY_SPELLING.get(match[2].lower())):
        return HeaderName(_words(match[1]), unit)
    if match and match[2] == "1" and {*_words(match[1])} & {*_SPELLINGS["ticks"], *_OF_COUNT}:
        return taken_apart(match[1])
    parts = name.split("_")  # `mV` would fall apart at its capital letter
    for length in (2, 1):
        unit = _BY_SPELLING.get("_".join(parts[-length:]).lower())
        if unit and len(parts) > length:
            return HeaderName(_words("_".join(parts[:-length])), unit)
    words = _words(name)
    for length in (2, 1):
        unit = _BY_SPELLING.get("_".join(words[-length:]))
        is_alone = len(words) == length
        if unit and len(words) >= length and (not is_alone or words[0] in _ALONE):
            return HeaderName(words[:-length], unit)
    return HeaderName(words, "")


def _words(name: str) -> tuple[str, ...]:
    parts = re.split(r"[^A-Za-z0-9°µ]+", _CAMEL.sub(" ", name))
    return tuple(part.lower() for part in parts if part)


def unit_of(text: str) -> str:
    """Return the unit of a spelling such as `deg`; empty if there is none."""
    return text if text in _SPELLINGS else _BY_SPELLING.get(text.lower(), "")


def unit_of_cell(cell: str) -> str:
    """Return the unit in a cell of a row of units, with or without brackets; empty if it is none."""
    return unit_of(cell.strip("[]() "))


def with_unit(name: str, cell: str) -> str:
    """Return the name of a column with the unit of a cell below it, if the name states none."""
    unit = cell.strip("[]() ")
    return f"{name} [{unit}]" if unit_of(unit) and not taken_apart(name).unit else name


def units_for(ours: str) -> tuple[str, ...]:
    """Return the units in which a log may have a quantity of our unit, ours first."""
    return (ours, *_per_unit(ours))


def _per_unit(ours: str) -> dict[str, float]:
    """Return how many of each other unit make one of ours."""
    return dict(OTHER_UNITS.get(ours, ())) | ({PERCENT: 100.0} if ours == "V" else {})


def factor_to(ours: str, unit: str, where: str) -> float:
    """Return the value in our unit for a value of 1 in the unit of a log; an empty unit is ours.

    Raises:
        InputError: The unit is not one of the quantity.
    """
    name = unit_of(unit) or unit
    if name in {"", ours}:
        return 1.0
    others = _per_unit(ours)
    if name not in others:
        allowed = ", ".join(units_for(ours)) if ours else "none: leave the unit out"
        raise InputError("unit", where=where, got=unit, allowed=allowed, nearest=nearest(unit, units_for(ours)))
    return 1.0 / others[name]
