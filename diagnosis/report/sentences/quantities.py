"""Numbers and names in words: a value with its error, a column with its unit, the meaning of an effect."""

from collections.abc import Sequence
from math import floor, isfinite, log10

from configs.effects.base import Effect
from diagnosis.inference.gain import Gain
from symolo.core.field_descriptions import field_descriptions

UNITS = {
    "rad_s": "rad/s",
    "m_s2": "m/s²",
    "m_s": "m/s",
    "rad": "rad",
    "lux": "lx",
    "ticks": "ticks",
    "s": "s",
    "m": "m",
    "A": "A",
    "V": "V",
    "C": "°C",
}
"""Unit by the end of a column's name, the longer ends first."""
NAMES = {
    "omega": "speed of the wheel",
    "u_cmd": "commanded voltage",
    "u": "voltage",
    "voltage_step": "step of the voltage since the previous row",
    "u_left": "voltage of the left motor",
    "u_right": "voltage of the right motor",
    "current": "current",
    "t": "time",
    "since_on": "time since switched on",
    "session_time": "time in the session",
    "time_since_step": "time since the last step",
    "distance": "distance",
    "previous_distance": "distance in the previous row",
    "distance_step": "step of the distance since the previous row",
    "from_middle": "distance from the middle of the object",
    "incidence": "angle of incidence",
    "temperature": "temperature",
    "ambient": "ambient light",
    "reading": "reading",
    "theta": "heading",
    "x": "place along x",
    "y": "place along y",
    "wheel_angle": "angle of the wheel",
    "wheel_left": "speed of the left wheel",
    "wheel_right": "speed of the right wheel",
    "pose_dx": "distance forward",
    "pose_dy": "distance to the left",
    "pose_dtheta": "turn",
    "turn": "rate of turning",
    "turn_reversal": "reversal of turning",
    "travel_reversal": "reversal of driving",
    "distance_since_start": "distance since the robot last started to drive",
    "turn_since_start": "turn since the robot last started to turn",
    "acceleration": "acceleration of the wheels",
    "wall_place": "place along the walls",
    "tof_front": "range ahead",
    "tof_left": "range to the left",
    "tof_right": "range to the right",
}
"""Meaning of a column's name without its unit."""
PREDICTED = frozenset({"omega_rad_s", "current_A"})
"""Covariates with the name of a reading. A reading contains its own error, so the covariate is its prediction."""
UNITLESS_NAMES = {
    "ds": ("distance by the wheels", "m"),
    "dtheta": ("turn by the wheels", "rad"),
    "wall": ("wall that is hit", ""),
}
"""Words and unit of columns whose names have no unit."""

ASSUMED = "assumed, or fitted within its tolerance"
"""What the report says of a number that has no part in the search for an effect."""


def quantity_words(column: str) -> tuple[str, str]:
    """Return a column in words, and its unit; the name itself and an empty unit if they are not known.

    The index of a column such as `wheel_angle_rad[left]` is part of the words.
    """
    if column in UNITLESS_NAMES:
        return UNITLESS_NAMES[column]
    column, _, which = column.removesuffix("]").partition("[")
    index = f", {which}" if which else ""
    for end, unit in UNITS.items():
        stem = column.removesuffix(f"_{end}")
        if stem != column:
            return NAMES.get(stem, stem.replace("_", " ")) + index, unit
    return column.replace("_", " ") + index, ""


def axis(column: str) -> str:
    """Return the label of an axis: the quantity with its unit."""
    words, unit = quantity_words(column)
    return f"{words} [{unit}]" if unit else words


def along(covariate: str) -> str:
    """Return the name of a covariate, with `predicted` if a reading has the same name."""
    return f"predicted {covariate}" if covariate in PREDICTED else covariate


def covariate_axis(covariate: str) -> str:
    """Return the label of an axis for a covariate."""
    return f"{'predicted ' if covariate in PREDICTED else ''}{axis(covariate)}"


def with_error(value: float, error: float, between: str = "±") -> str:
    """Return a value with two digits of its error, `0.9300 ± 0.0067`; the value alone if there is no error."""
    if not isfinite(error) or error <= 0.0:
        return f"{value:.4g}"
    decimals = 1 - floor(log10(error))
    if -4 < decimals < 10 and abs(value) < 1e6:
        return f"{value:.{max(decimals, 0)}f} {between} {error:.{max(decimals, 0)}f}"
    return f"{value:.4g} {between} {error:.2g}"


def listed(names: Sequence[str]) -> str:
    """Return names as `a, b and c`."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def confidence(probability: float) -> str:
    """Return a probability in percent, never as certainty."""
    return "over 99.9 %" if probability >= 0.999 else percent(probability)


def gain_text(gain: Gain) -> str:
    """Return a gain with its interval; an interval without width comes from a single block of rows."""
    if gain.is_unchanged:
        return f"{percent(0.0)} (no change)"
    interval = f"95 % interval {percent(gain.low)} to {percent(gain.high)}"
    return f"{percent(gain.value)} ({interval if gain.high > gain.low else 'too few rows for an interval'})"


def percent(share: float) -> str:
    """Return a gain or a probability in percent."""
    shown = 100.0 * share
    return f"{shown:.3g} %" if abs(shown) >= 1.0 or shown == 0.0 else f"{shown:.1f} %"


def cost(value: float) -> str:
    """Return a cost, with tenths if it is small."""
    return f"{value:.1f}" if abs(value) < 100.0 else f"{value:.0f}"


def meaning(effect: type[Effect]) -> str:
    """Return the description of the effect's first number, which is its equation: `R_true = scale * R`."""
    descriptions = field_descriptions(effect)
    return " ".join(next((descriptions[name] for name in effect.parameters() if name in descriptions), "").split())
