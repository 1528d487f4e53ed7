"""Names of units in the headers of logs, and their factors to our units."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

from logs.units.plausible import OTHER_UNITS
from symolo.core.errors import InputError, nearest

_SPELLINGS: Mapping[str, tuple[str, ...]] = {
    "m": ("m", "meter", "meters", "metre", "metres"),
    "cm": ("cm", "centimeter", "centimeters", "centimetre", "centimetres"),
    "mm": ("mm", "millimeter", "millimeters", "millimetre", "millimetres"),
    "um": ("um", "µm", "micron", "microns"),
    "in": ("in", "inch", "inches"),
    "ft": ("ft", "foot", "feet"),
    "rad": ("rad", "radian", "radians"),
    "mrad": ("mrad", "milliradians"),
    "degrees": ("deg", "degree", "degrees", "°", "grad"),
    "gon": ("gon", "gons", "gradian", "gradians"),
    "turns": ("turns", "rev", "revs", "revolutions"),
    "s": ("s", "sec", "secs", "second", "seconds"),
    "ms": ("ms", "msec", "msecs", "millis", "milliseconds"),
    "us": ("us", "µs", "usec", "usecs", "micros", "microseconds"),
    "ns": ("ns", "nsec", "nsecs", "nanos", "nanoseconds"),
    "minutes": ("min", "minutes"),
    "V": ("v", "volt", "volts"),
    "mV": ("mv", "millivolt", "millivolts"),
    "A": ("a", "amp", "amps", "ampere", "amperes"),
    "mA": ("ma", "milliamp", "milliamps"),
    "m/s": ("m/s", "m_s", "mps"),
    "cm/s": ("cm/s", "cm_s"),
    "mm/s": ("mm/s", "mm_s"),
    "in/s": ("in/s", "inch/s", "inches/s"),
    "ft/s": ("ft/s", "ft_s"),
    "km/h": ("km/h", "km_h", "kmh", "kmph", "kph"),
    "mph": ("mph", "mi/h", "mi_h"),
    "rad/s": ("rad/s", "rad_s", "rads"),
    "mrad/s": ("mrad/s", "mrad_s"),
    "degrees per second": ("deg/s", "deg_s", "°/s", "°_s", "dps"),
    "rpm": ("rpm", "rev/min", "r/min", "u/min", "1/min", "min-1", "min^-1"),
    "turns per second": ("rev/s", "rev_s", "r/s", "rps"),
    "ticks": ("ticks", "tick", "counts", "count", "cnt", "pulses", "steps"),
    "degC": ("degc", "°c", "celsius", "c"),
    "lx": ("lx", "lux"),
    "percent": ("percent", "pct", "%"),
}
_STATED_UNITS: Mapping[str, tuple[tuple[str, float], ...]] = {
    "m": (("um", 1e6), ("in", 1.0 / 0.0254), ("ft", 1.0 / 0.3048)),
    "rad": (("mrad", 1e3), ("gon", 200.0 / pi), ("turns", 0.5 / pi)),
    "rad/s": (("mrad/s", 1e3), ("turns per second", 0.5 / pi)),
    "s": (("minutes", 1.0 / 60.0),),
    "m/s": (("in/s", 1.0 / 0.0254), ("ft/s", 1.0 / 0.3048), ("km/h", 3.6), ("mph", 1.0 / 0.44704)),
}
"""Units that are never guessed, by our unit, and how many of them make one of ours. An inch, a foot and a mile per hour
are 0.0254 m, 0.3048 m and 0.44704 m/s exactly; a gon is a 400th of a turn (NIST SP 811, appendix B)."""
PERCENT = "percent"
"""Unit of a duty cycle; the voltage of a full one is the factor besides the unit."""
_BY_SPELLING = {spelling: unit for unit, spellings in _SPELLINGS.items() for spelling in spellings}
_ALONE = frozenset({"ms", "us", "millis", "micros", "rpm", "seconds", "milliseconds", "microseconds"})
"""Spellings that are a unit even if the name of a column has no other word."""
_BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
NO_UNIT = frozenset({"1", "-", "[1]", "[-]", "(1)", "(-)"})
"""Ways to write in a row of units that a quantity has none."""
_ENCODER_WORDS = frozenset({"enc", "encoder", "encoders"})
"""Words of counts, beside the spellings of ticks: behind them, [1] means no unit and not the first of several."""
_PER_SECOND = re.compile(r"[ .·*]?s(\^?-1|⁻¹)$|[/_]secs?$|[/_]seconds?$")
"""Ways to write a quotient with a second."""
_INCH, _LENGTHS = (
    "in",
    frozenset(["x", "y", "z", "pos", "position", "dist", "distance", "range", "length", "tof", "lidar", "sonar"]),
)
"""Spelling of the inch that behind other words, as in `battery_in`, is none."""
_MINUTE = "min"
"""Spelling of the minute that stands for it in brackets alone; `range_min` is a minimum."""
NO_UNIT_WORDS = frozenset(
    [
        "left",
        "right",
        "front",
        "l",
        "r",
        "x",
        "y",
        "z",
        "raw",
        "filtered",
        "smoothed",
        "measured",
        "logged",
        "true",
        "set",
        "ccw",
        "cw",
        "clockwise",
        "counterclockwise",
        "odom",
        "mocap",
        "kalman",
        "ekf",
        "ukf",
        "fused",
        "est",
        "estimated",
    ]
)
"""Words that may stand in brackets behind a name and are no unit."""
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


@dataclass(frozen=True)
class HeaderName:
    """The name of a column, taken apart."""

    words: tuple[str, ...]
    """Lower-case words without the unit."""
    unit: str
    """Unit that the name states, such as `mm` or `degrees`; empty if it states none."""
    unknown: str = field(default="", compare=False)
    """Text in brackets at the end of the name that is no unit that is known; its words are among `words`."""


def taken_apart(name: str) -> HeaderName:
    """Return words and unit of a name such as `x [mm]`, `heading_deg`, `timeMs` or `motor_left (V)`."""
    match = _BRACKETS.match(name)
    stated = match[2].removeprefix("in ").rstrip(".") if match else ""  # as in `time (in s)`
    if match and (unit := unit_of(stated)):
        return HeaderName(words_of(match[1]), unit)
    if match and (parts := re.split(r"\s*[,;]\s*", stated)) and len(parts) > 1 and (unit := unit_of(parts[-1])):
        return HeaderName(words_of(" ".join((match[1], *parts[:-1]))), unit)  # as in `speed (left wheel, m/s)`
    if match and match[2] == "1" and {*words_of(match[1])} & {*_SPELLINGS["ticks"], *_ENCODER_WORDS}:
        return taken_apart(match[1])
    if name.endswith("%") and (words := words_of(name[:-1])):
        return HeaderName(words, PERCENT)
    words = words_of(name)
    if match and {word for word in words_of(match[2]) if not word.isdecimal()} - NO_UNIT_WORDS:
        return HeaderName(words, "", match[2])  # the `V` of [kV] is not its unit
    parts = name.split("_")  # `mV` would fall apart at its capital letter
    for length in (3, 2, 1):
        unit = _unit_behind(words_of("_".join(parts[:-length])), "_".join(parts[-length:]))
        if unit and len(parts) > length:
            return HeaderName(words_of("_".join(parts[:-length])), unit)
    for length in (3, 2, 1):
        unit = _unit_behind(words[:-length], "_".join(words[-length:]))
        is_alone = len(words) == length
        if unit and len(words) >= length and (not is_alone or words[0] in _ALONE):
            return HeaderName(words[:-length], unit)
    return HeaderName(words, "")


def _unit_behind(words: tuple[str, ...], spelling: str) -> str:
    """Return the unit of a spelling behind the words of a name; empty if it is none."""
    if words[-1:] == ("per",) or spelling.lower() == _MINUTE or (spelling.lower() == _INCH and not _LENGTHS & {*words}):
        return ""
    return unit_of(spelling.replace("_per_", "_"))


def words_of(name: str) -> tuple[str, ...]:
    """Return the lower-case words of a name such as `pose.orientation.x` or `RotationX`."""
    parts = re.split(r"[^A-Za-z0-9°µμ]+", _CAMEL.sub(" ", name))
    return tuple(part.lower() for part in parts if part)


def unit_of(text: str) -> str:
    """Return the unit of a spelling such as `deg`; empty if there is none."""
    if text in _SPELLINGS:
        return text
    spelling = text.lower().replace("μ", "µ")  # the Greek letter and the sign of the prefix look alike
    return _BY_SPELLING.get(spelling) or _BY_SPELLING.get(_PER_SECOND.sub("/s", spelling), "")


def unit_of_cell(cell: str) -> str:
    """Return the unit in a cell of a row of units, with or without brackets; empty if it is none."""
    return unit_of(cell.strip("[]() "))


def with_unit(name: str, cell: str) -> str:
    """Return the name of a column with the unit of a cell below it, if the name states none."""
    unit = cell.strip("[]() ")
    return name if cell in {"", *NO_UNIT} or taken_apart(name).unit else f"{name} [{unit}]"


def units_for(ours: str) -> tuple[str, ...]:
    """Return the units in which a log may have a quantity of our unit, ours first."""
    return (ours, *per_unit(ours))


def per_unit(ours: str) -> dict[str, float]:
    """Return how many of each other unit make one of ours."""
    others = dict((*OTHER_UNITS.get(ours, ()), *_STATED_UNITS.get(ours, ())))
    return others | ({PERCENT: 100.0} if ours == "V" else {})


def fits(header: HeaderName, ours: str) -> bool:
    """Return whether a column with such a name may hold a quantity that we measure in `ours`.

    A name without a unit may be that of anything, and one with an unknown unit in brackets of nothing.
    """
    return not ours or (header.unit in units_for(ours) if header.unit else not header.unknown)


def factor_to(ours: str, unit: str, where: str) -> float:
    """Return the value in our unit for a value of 1 in the unit of a log; an empty unit is ours.

    Raises:
        InputError: The unit is not one of the quantity.
    """
    name = unit_of(unit) or unit
    if name in {"", ours}:
        return 1.0
    others = per_unit(ours)
    if name not in others:
        allowed = ", ".join(units_for(ours)) if ours else "none: leave the unit out"
        raise InputError("unit", where=where, got=unit, allowed=allowed, nearest=nearest(unit, units_for(ours)))
    return 1.0 / others[name]
