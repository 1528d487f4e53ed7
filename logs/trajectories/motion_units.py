"""Units of times and places without a unit in their names, from the motion that they would give.

A column alone says little: 50 may be seconds or milliseconds. Together, the units must give a motion that a small robot
can make.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from logs.times import usual_step
from logs.units import names
from logs.units.plausible import OTHER_UNITS
from logs.units.possible_motion import LONGEST_STEP_S, SHORTEST_STEP_S
from symolo.core.arrays import Array

USUAL_M_S = 0.3
"""Speed of a small robot; of several units that are possible, that with the speed nearest to it is taken."""
SLOWEST_M_S, FASTEST_M_S = 0.005, 5.0
WIDEST_M = 100.0


def per_unit(ours: str) -> Mapping[str, float]:
    """Return how many of each unit make one of ours; an empty name is ours."""
    return {"": 1.0, **names.per_unit(ours)}


def guessable(ours: str) -> list[str]:
    """Return the units that a column may have whose name states none; an empty name is ours."""
    return ["", *(name for name, _ in OTHER_UNITS[ours])]


def time_and_length(t: Array, place: Array, time_units: Sequence[str], length_units: Sequence[str]) -> tuple[str, str]:
    """Return the units of times (N,) and places (N, 2) that give the most usual speed; empty names are s and m.

    Args:
        t: Times, increasing.
        place: Places.
        time_units: Possible units of the times; the first is taken if none gives a possible motion.
        length_units: Possible units of the places.
    """
    per_s, per_m = per_unit("s"), per_unit("m")
    steps, ways = np.diff(t), np.hypot(*np.diff(place, axis=0).T)
    moves = (ways > 0.0) & (steps > 0.0)
    with np.errstate(over="ignore"):  # of a place that is not on Earth, which is refused later
        speed = float(np.median(ways[moves] / steps[moves])) if moves.any() else 0.0
    step = usual_step(steps[steps > 0.0]) if np.any(steps > 0.0) else 0.0
    extent = float(np.ptp(place, axis=0).max())

    def cost(pair: tuple[str, str]) -> tuple[bool, bool, bool, float, int]:
        time, length = pair
        step_s, speed_m_s, extent_m = step / per_s[time], speed * per_s[time] / per_m[length], extent / per_m[length]
        is_possible = SLOWEST_M_S <= speed_m_s <= FASTEST_M_S or speed == 0.0
        away = abs(math.log(speed_m_s / USUAL_M_S)) if speed_m_s > 0.0 else 0.0
        plain = time_units.index(time) + length_units.index(length)
        # Metres at a possible speed need no other unit, however far that speed is from the usual one.
        return (
            not SHORTEST_STEP_S <= step_s <= LONGEST_STEP_S,
            not is_possible,
            extent_m > WIDEST_M,
            0.0 if is_possible and length == "" else away,
            plain,
        )

    return min(product(time_units, length_units), key=cost)
