"""Whether a column can be in its unit at all, and in which one it more likely is.

A log in millimetres under a header in metres reads without an error and makes every later result wrong by a thousand.
One wild value is an outlier and stays; a column whose middle is out of reach is refused.
"""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array

_OTHER_UNITS = {
    "m": (("mm", 1e3), ("cm", 1e2)),
    "rad": (("degrees", 180.0 / np.pi),),
    "rad/s": (("rpm", 30.0 / np.pi), ("degrees per second", 180.0 / np.pi)),
    "s": (("ms", 1e3), ("us", 1e6)),
    "A": (("mA", 1e3),),
    "V": (("mV", 1e3),),
    "m/s": (("mm/s", 1e3), ("cm/s", 1e2)),
}
"""By unit: others that logs come in, and how many of them make one."""


@dataclass(frozen=True)
class Reach:
    """What a quantity of a small robot can be, wide enough for any of them."""

    low: float
    high: float

    def holds(self, values: Array) -> np.ndarray:
        """(N,), true where a value is within or missing."""
        return ~((values < self.low) | (values > self.high))

    def words(self, unit: str) -> str:
        return f"{self.low:g} to {self.high:g} {unit}".strip()


def beyond_scale(values: Array, reach: Reach) -> float | None:
    """The median size of the values, if more than half of those given are out of reach; NaN are left out."""
    given = values[np.isfinite(values)]
    if not len(given) or 2 * np.count_nonzero(~reach.holds(given)) <= len(given):
        return None
    return float(np.median(np.abs(given)))


def likely_unit(typical: float, reach: Reach, unit: str) -> str:
    """A cure: the unit in which such a value would be within reach, or an empty string."""
    fits = [(name, per) for name, per in _OTHER_UNITS.get(unit, ()) if reach.low <= typical / per <= reach.high]
    if not fits:
        return ""
    names = " or ".join(name for name, _ in fits)
    factors = " or ".join(f"{per:.4g}" for _, per in fits)
    return f"this looks like {names}: divide by {factors}"


def mixed_up_unit(ratio: float, unit: str) -> str:
    """The unit whose factor is within 30 % of how many times too large values are, or an empty string."""
    fits = [f"{name}: divide by {per:.4g}" for name, per in _OTHER_UNITS.get(unit, ()) if 0.7 < ratio / per < 1.3]
    return fits[0] if fits else ""
