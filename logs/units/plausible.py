"""Checks whether a column can be in its unit, and in which other unit it is likely to be.

A log in millimetres under a header in metres can be read without an error, and then every later result is wrong by a
factor of a thousand. A single extreme value is an outlier and stays; a column with an implausible median is refused.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from symolo.core.arrays import Array

OTHER_UNITS: Mapping[str, tuple[tuple[str, float], ...]] = {
    "m": (("mm", 1e3), ("cm", 1e2)),
    "rad": (("degrees", 180.0 / np.pi),),
    "rad/s": (("rpm", 30.0 / np.pi), ("degrees per second", 180.0 / np.pi)),
    "s": (("ms", 1e3), ("us", 1e6), ("ns", 1e9)),
    "A": (("mA", 1e3),),
    "V": (("mV", 1e3),),
    "m/s": (("mm/s", 1e3), ("cm/s", 1e2)),
}
"""Other units in which logs come, by our unit, and how many of them make one of ours."""
MIN_NONZERO = 5
"""Number of values other than zero from which on these alone show the unit; a single one may be an outlier."""
DUTY_ADVICE = "a duty cycle: multiply by the supply voltage, and divide by the value of a full duty cycle"


@dataclass(frozen=True)
class PlausibleRange:
    """Range of the values that a quantity of a small robot can have, with wide margins."""

    low: float
    high: float

    def holds(self, values: Array) -> np.ndarray:
        """Return which values (N,) are possible or missing."""
        return ~((values < self.low) | (values > self.high))

    def words(self, unit: str) -> str:
        return f"{self.low:g} to {self.high:g} {unit}".strip()


def beyond_scale(values: Array, plausible: PlausibleRange) -> float | None:
    """Return the median size of the values if more than half of them are implausible, else None.

    Missing values are left out, and so are zeros beside enough other values: a motor that rests has 0 V in any unit.
    """
    known = values[np.isfinite(values)]
    if np.count_nonzero(known) >= MIN_NONZERO:
        known = known[known != 0.0]
    if not len(known) or 2 * np.count_nonzero(~plausible.holds(known)) <= len(known):
        return None
    return float(np.median(np.abs(known)))


def likely_unit(typical: float, plausible: PlausibleRange, unit: str) -> str:
    """Return advice that names the unit in which such a value would be possible, or an empty string."""
    fits = [(name, per) for name, per in OTHER_UNITS.get(unit, ()) if plausible.low <= typical / per <= plausible.high]
    if not fits:
        return ""
    names = " or ".join(name for name, _ in fits)
    factors = " or ".join(f"{per:.4g}" for _, per in fits)
    or_duty = f"; or like {DUTY_ADVICE}" if unit == "V" else ""
    return f"this looks like {names}: divide by {factors}{or_duty}"


def mixed_up_unit(ratio: float, unit: str) -> str:
    """Return the unit whose factor is within 30 % of this ratio, with advice; an empty string if there is none."""
    fits = [f"{name}: divide by {per:.4g}" for name, per in OTHER_UNITS.get(unit, ()) if 0.7 < ratio / per < 1.3]
    return fits[0] if fits else ""


def confused_units(ratio: float, unit: str) -> str:
    """Return the two units whose factor is within 30 % of this ratio, with advice; an empty string if there are none.

    Args:
        ratio: Values that were taken for those of a stated unit, by what they should be.
        unit: Our unit, in which both are.
    """
    if plain := mixed_up_unit(ratio, unit):
        return plain
    units = ((unit, 1.0), *OTHER_UNITS.get(unit, ()))
    for (actual, per), (stated, stated_per) in permutations(units, 2):
        factor = per / stated_per
        if 0.7 < ratio / factor < 1.3:
            cure = f"divide by {factor:.4g}" if factor > 1.0 else f"multiply by {1.0 / factor:.4g}"
            return f"{actual} and was taken for {stated}: {cure}"
    return ""
