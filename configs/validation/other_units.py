"""Questions whether a number that is out of its bounds has another unit than that of its field."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees, radians

MAX_HINTED = 1e9
"""Largest number that may have a wrong unit; a larger one is a mistake of another kind, and may overflow."""

_COEFFICIENT = re.compile(r"(^|_)[kp]\d$")
"""Fields with coefficients of a polynomial, which are no parts of anything."""
MIN_PER_CENT = 2.0
"""Smallest number in the place of a part of 1 that may be in per cent; a smaller one is a little too large."""


@dataclass(frozen=True)
class OtherUnits:
    """Units in which numbers of one kind are often written by mistake."""

    ending: re.Pattern[str]
    """End of the names of the fields."""
    words: str
    """Unit of the fields, after "is it"."""
    units: Sequence[tuple[str, float]]
    """Other units, and their factors to that of the field."""
    times: float = 1.0
    """How far the size of a number is beyond the largest bound, or within the smallest, to be suspicious."""
    is_below: bool = False
    """Whether numbers in these units are too small, in the place of too large."""


_SIMPLE = r"(?<!_m)(?<!_rad)(?<!_N)(?<!_per)(?<!_1)"
"""Before the unit of a length, time, mass or voltage, and not of a speed, torque or quotient."""
_UNITS = (
    OtherUnits(re.compile(rf"{_SIMPLE}_m$"), "in metres", (("cm", 0.01), ("mm", 0.001)), times=2.0),
    OtherUnits(re.compile(rf"{_SIMPLE}_s$"), "in seconds", (("ms", 0.001),), times=2.0),
    OtherUnits(re.compile(rf"{_SIMPLE}_kg$"), "in kilograms", (("g", 0.001),), times=2.0),
    OtherUnits(re.compile(rf"{_SIMPLE}_V$"), "in volts", (("mV", 0.001),), times=2.0),
    OtherUnits(re.compile(r"_m_s$"), "in metres per second", (("cm/s", 0.01), ("mm/s", 0.001)), times=2.0),
    OtherUnits(re.compile(r"_mm$"), "in millimetres", (("m", 1000.0),), is_below=True),
    OtherUnits(re.compile(r"_klm$"), "in kilolumens", (("lm", 0.001),), times=2.0),
    OtherUnits(re.compile(r"_klx$"), "in kilolux", (("lx", 0.001),), times=2.0),
    OtherUnits(re.compile(r"_deg$"), "in degrees", (("rad", degrees(1.0)),), is_below=True),
    OtherUnits(re.compile(r"(?<!_s)(?<!_m)(?<!_V)_rad$"), "in radians", (("deg", radians(1.0)),), times=1.5),
    OtherUnits(re.compile(r"(?<!_m)_rad_s$"), "in radians per second", (("deg/s", radians(1.0)),)),
)
_HAS_UNIT = re.compile(r"_(m|mm|um|m2|m3|s|kg|g|V|A|W|N|K|C|deg|rad|hz|Hz|rtHz|px|ohm|lux|klm|klx|bits|turn)$")
"""End of the name of a number that has a unit."""


def other_unit(field: str, got: float, low: float, high: float) -> str:
    """Return the question whether a number has another unit; empty where no usual unit brings it within its bounds.

    Args:
        field: Name of the field, which ends with its unit.
        got: The number.
        low: Smallest allowed number.
        high: Largest allowed number.
    """
    if abs(got) > MAX_HINTED or low <= got <= high:
        return ""
    for each in _UNITS:
        if each.ending.search(field):
            suspicious = 0.0 < got < low if each.is_below else abs(got) >= each.times * max(abs(low), abs(high))
            fitting = [f"{got:g} {unit} are {got * per:.6g}" for unit, per in each.units if low <= got * per <= high]
            if suspicious and field == "period_s" and low <= 1.0 / got <= high:
                fitting.append(f"a rate of {got:g} Hz is {1.0 / got:.4g}")
            return f"is it {each.words}? {', '.join(fitting)}" if suspicious and fitting else ""
    fitting = [] if _HAS_UNIT.search(field) else list(_units_by_factor(field, got, low, high))
    return f"is it {' '.join(fitting)}" if fitting else ""


def _units_by_factor(field: str, got: float, low: float, high: float) -> Iterator[str]:
    """Yield what a number without a unit may be: a part or factor in per cent, or the deviation of a factor from 1."""
    in_per_cent = f"{got:g} % are {0.01 * got:.6g}"
    if re.search(r"(^|_)scale$", field) and 0.0 < low < 1.0 < high:
        if got > high and low <= 0.01 * got <= high:
            yield f"a factor? {in_per_cent}"
        elif low <= 1.0 + got <= high:
            yield f"a factor? with a deviation of {got:g} it is {1.0 + got:.6g}"
    elif (
        max(abs(low), high) <= 1.0
        and not _COEFFICIENT.search(field)
        and abs(got) >= MIN_PER_CENT
        and low <= 0.01 * got <= high
    ):
        yield f"a part of 1? {in_per_cent}"
