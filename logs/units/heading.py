"""Unit of a heading whose name states none, from the motion that it would give."""

import math

import numpy as np

from logs.trajectories.path_direction import (
    MAX_UNJUDGED_CHORDS,
    UNEXPLAINED_RAD,
    angle_to_path,
    chords,
    turn_to_path,
)
from logs.units.wrapped_angles import BEYOND_RAD, MIN_WRAP_DEG, TURN_RAD
from symolo.core.arrays import Array

FASTEST_TURN_RAD_S = 12.0
"""Speed at which no small robot turns for long; a heading that changes faster is in degrees."""
_UNITS = {"radians": "", "degrees": "degrees"}
"""Unit of a column by its name in a message."""
_MIN_MARGIN_RAD = math.radians(5.0)
"""Smallest difference by which headings must follow the path better in one unit than in the other."""
_MAX_WRAP_SHARE = 0.2
"""Largest share of steps at which a heading is wrapped."""


def guessed_heading_unit(t_s: Array, place_m: Array | None, heading: Array) -> tuple[str, str]:
    """Return `degrees`, or an empty name for radians, and the reason as a part of a sentence.

    A robot rolls along its heading, so the path decides. Headings of another convention, such as those of a compass,
    follow it up to a constant angle. Without a path that shows the unit, the values and their changes decide.

    Args:
        t_s: (N,), times; NaN where there is none.
        place_m: (N, 2), places; NaN where there is none; None if none were logged.
        heading: (N,), values of the heading; NaN where there is none.
    """
    if place_m is not None:
        known = np.isfinite(heading) & np.isfinite(place_m).all(axis=1)
        unit, reason = _unit_along(place_m[known], heading[known]) if known.any() else ("", "")
        if reason:
            return unit, reason
    known = np.isfinite(heading)
    return _unit_of_values(t_s[known], heading[known]) if known.any() else ("", "")


def _unit_along(place_m: Array, heading: Array) -> tuple[str, str]:
    """Return the unit in which headings follow the path, and the reason; no reason if the path does not show it."""
    ends = chords(place_m)
    if len(ends) <= MAX_UNJUDGED_CHORDS:
        return "", ""
    place, as_radians, as_degrees = place_m[ends], heading[ends], np.radians(heading[ends])
    if name := _better(angle_to_path(place, as_radians), angle_to_path(place, as_degrees)):
        return _UNITS[name], f"since the headings follow the path in {name}"
    # Any heading that hardly changes turns with a straight path.
    if _turned_to_path(place, np.zeros(len(place))) < UNEXPLAINED_RAD:
        return "", ""
    name = _better(_turned_to_path(place, as_radians), _turned_to_path(place, as_degrees))
    return (_UNITS[name], f"since the headings turn with the path in {name}") if name else ("", "")


def _better(off_radians: float, off_degrees: float) -> str:
    """Return the unit with the smaller angle [rad] to the path, if it explains the headings and the other does not."""
    smaller, larger = sorted((off_radians, off_degrees))
    if smaller > UNEXPLAINED_RAD or larger < UNEXPLAINED_RAD or larger - smaller < _MIN_MARGIN_RAD:
        return ""
    return "degrees" if off_degrees < off_radians else "radians"


def _turned_to_path(place: Array, yaw_rad: Array) -> float:
    """Return the angle to the path [rad] after the best constant turn, counted in either sense."""
    return min(angle_to_path(place, yaw + turn_to_path(place, yaw)) for yaw in (yaw_rad, -yaw_rad))


def _unit_of_values(t_s: Array, heading: Array) -> tuple[str, str]:
    """Return the unit that values and changes of a heading (N,) suggest, and the reason."""
    largest, steps = float(np.abs(heading).max()), np.abs(np.diff(heading))
    if largest > BEYOND_RAD:
        # Steps of some degrees may be as large as a turn in radians, so a jump by 360 decides first.
        if np.any(steps > MIN_WRAP_DEG):
            return "degrees", f"since the values jump by {steps.max():.4g}"
        if abs(float(heading[0])) > BEYOND_RAD:
            return "degrees", f"since the values begin at {heading[0]:.4g}"
        if (rate := _usual_rate(t_s, steps)) > FASTEST_TURN_RAD_S:
            return "degrees", f"since the robot would turn at {rate:.3g} rad/s in radians"
        if np.all(heading == np.rint(heading)):
            return "degrees", f"since the values are whole numbers up to {largest:.3g}"
        return "", f"since the values are up to {largest:.3g} (which may be degrees, too: nothing shows the unit)"
    return "", f"since the values are up to {largest:.3g}"


def _usual_rate(t_s: Array, steps: Array) -> float:
    """Return the rate of turn [rad/s] that a heading in radians rarely exceeds, without the jumps where it wraps."""
    wraps = np.abs(steps - TURN_RAD) < 1.0
    passed_s = np.diff(t_s)
    counts = passed_s > 0.0
    if np.mean(wraps) < _MAX_WRAP_SHARE:
        counts &= ~wraps
    return float(np.quantile(steps[counts] / passed_s[counts], 0.9)) if counts.any() else 0.0
