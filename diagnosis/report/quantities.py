"""Numbers and names as people read them: a value with its error, a column with its unit, an effect in words."""

from math import floor, isfinite, log10

from configs.effects.base import Effect

UNITS = {
    "rad_s": "rad/s",
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
"""By the end of a column's name, the longer ones first."""
NAMES = {
    "omega": "speed of the wheel",
    "u_cmd": "voltage commanded",
    "u": "voltage",
    "u_left": "voltage of the left motor",
    "u_right": "voltage of the right motor",
    "current": "current",
    "t": "time",
    "since_on": "time since switched on",
    "session_time": "time in the session",
    "time_since_step": "time since the last step",
    "distance": "distance",
    "previous_distance": "distance of the row before",
    "incidence": "angle of incidence",
    "temperature": "temperature",
    "ambient": "ambient light",
    "reading": "reading",
    "theta": "heading",
    "wheel_angle": "angle of the wheel",
    "wheel_left": "speed of the left wheel",
    "wheel_right": "speed of the right wheel",
    "pose_dx": "way ahead",
    "pose_dy": "way to the left",
    "pose_dtheta": "turn",
    "tof_front": "range ahead",
    "tof_left": "range to the left",
    "tof_right": "range to the right",
}
"""What a column's name means, without its unit."""
PREDICTED = frozenset({"omega_rad_s", "current_A"})
"""Covariates that have the name of a reading: a reading tells nothing of its own error, so they are its prediction."""


WHOLE = {"ds": ("way by the wheels", "m"), "dtheta": ("turn by the wheels", "rad"), "wall": ("wall that is met", "")}
"""Names that carry no unit."""


def named(column: str) -> tuple[str, str]:
    """What a column is, in words, and its unit; the name itself and nothing where neither is known.

    One of several, such as `wheel_angle_rad[left]`, keeps that in words.
    """
    if column in WHOLE:
        return WHOLE[column]
    column, _, which = column.removesuffix("]").partition("[")
    of = f", {which}" if which else ""
    for end, unit in UNITS.items():
        stem = column.removesuffix(f"_{end}")
        if stem != column:
            return NAMES.get(stem, stem.replace("_", " ")) + of, unit
    return column.replace("_", " ") + of, ""


def axis(column: str) -> str:
    """Of a plot: what is shown, with its unit."""
    words, unit = named(column)
    return f"{words} [{unit}]" if unit else words


def along(covariate: str) -> str:
    """A covariate by name, said to be predicted where a reading has the same name."""
    return f"predicted {covariate}" if covariate in PREDICTED else covariate


def covariate_axis(covariate: str) -> str:
    """Of a plot over a covariate."""
    return f"{'predicted ' if covariate in PREDICTED else ''}{axis(covariate)}"


def with_error(value: float, error: float, between: str = "±") -> str:
    """To two digits of the error: `0.930 ± 0.0067`; the value alone where there is no error."""
    if not isfinite(error) or error <= 0.0:
        return f"{value:.4g}"
    decimals = 1 - floor(log10(error))
    if -4 < decimals < 10 and abs(value) < 1e6:
        return f"{value:.{max(decimals, 0)}f} {between} {error:.{max(decimals, 0)}f}"
    return f"{value:.4g} {between} {error:.2g}"


def confidence(probability: float) -> str:
    """In percent, and never certainty."""
    return "over 99.9 %" if probability >= 0.999 else percent(probability)


def interval(low: float, high: float) -> str:
    """Of a gain; where it has no width, there was but one block to draw from."""
    return f"95 % interval {percent(low)} to {percent(high)}" if high > low else "too few rows for an interval"


def percent(share: float) -> str:
    """Of a gain or a probability."""
    shown = 100.0 * share
    return f"{shown:.3g} %" if abs(shown) >= 1.0 or shown == 0.0 else f"{shown:.1f} %"


def cost(of: float) -> str:
    """With tenths where they mean something."""
    return f"{of:.1f}" if abs(of) < 100.0 else f"{of:.0f}"


def meaning(effect: type[Effect]) -> str:
    """What the effect does, as the schema has it: `R_true = scale * R`."""
    told = (field.description for field in effect.model_fields.values())
    return " ".join((next((text for text in told if text), "")).split())
