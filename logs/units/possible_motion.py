"""Refusal of motions that no small robot makes, because a unit of the log is wrong."""

from collections.abc import Callable

import numpy as np

from logs.times import usual_step
from symolo.core.arrays import Array
from symolo.core.errors import InputError

Where = Callable[[int], str]
"""Returns the place of a row for messages, such as `data.csv:7`."""

MAX_POSSIBLE_M_S = 10.0
"""Largest speed that a small robot can have; most drive at 0.1 to 1 m/s, which seconds turn into 100 or more."""
SHORTEST_STEP_S, LONGEST_STEP_S = 2e-4, 5.0
"""Usual steps between the rows of a log."""
MAX_PATH_WIDTH_M = 100.0
"""Width of a path from which on a robot that is too fast has places in millimetres, rather than times in seconds."""


def check_motion(t_s: Array, place: Array, at: Where, cure: str, *, column: str = "t") -> None:
    """Refuse a robot that is too fast, and rows that follow each other too fast.

    Args:
        t_s: (N,), increasing times.
        place: (N, 2), x [m] and y [m]; NaN where none is logged.
        at: Place of a row for messages.
        cure: What the user can do.
        column: Column that is likely to be wrong.

    Raises:
        InputError: The units cannot be right.
    """
    steps_s, ways = np.diff(t_s), np.hypot(*np.diff(place, axis=0).T)
    moves = np.flatnonzero((ways > 0.0) & (steps_s > 0.0))
    # The median counts, so that a jump is no reason.
    if len(moves) and (speed := float(np.median(ways[moves] / steps_s[moves]))) > MAX_POSSIBLE_M_S:
        what = f"the robot moves at {speed:.3g} m/s, more than {MAX_POSSIBLE_M_S:g} m/s"
        raise InputError(f"column {column}: {what}", where=at(int(moves[0])), cure=cure)
    if len(steps_s) and (step_s := usual_step(steps_s)) < SHORTEST_STEP_S:
        what = f"column {column}: rows are {step_s:.4g} s apart"
        raise InputError(what, where=at(0), allowed=f"at least {SHORTEST_STEP_S:g} s", cure=cure)


def larger_time_unit(unit: str) -> str:
    """Return the next larger unit of times, such as s for ms; empty if there is none."""
    return {"ms": "s", "us": "ms", "ns": "us"}.get(unit, "")
