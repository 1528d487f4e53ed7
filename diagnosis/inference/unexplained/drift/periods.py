"""The search for the number of periods at which a repeating offset explains most of a series."""

from collections.abc import Callable

import numpy as np

from diagnosis.inference.unexplained.drift.range_series import RangeSeries
from symolo.core.arrays import Array

MIN_PERIODS = 2.0
"""Smallest number of periods; an error that does not repeat cannot be distinguished from a drift."""
MIN_ROWS = 3.0
"""Smallest mean number of rows in a period."""
STEP = 1.0 / 8.0
"""Step of the number of periods, by which the edges of the last one move by at most 1/16 of a period."""
REFINED = 3
"""Number of periods near which the search is refined."""
FINE_STEPS = 1.0 / 64.0 * np.arange(-4, 5)
"""Changes of the number of periods that are tried there."""

Explained = Callable[[Array], float]
"""Squares that an offset explains, in standard deviations of the rows, by the phase (n,) of each row in 0 to 1."""


def squares_of_repeating(series: RangeSeries, explained: Explained, coarsely: Explained) -> tuple[float, float]:
    """Return the squares that the best number of periods leaves, and how many periods there could be.

    Args:
        series: The residuals in order of time.
        explained: Squares that the offset explains.
        coarsely: The same, perhaps approximately, for the first look at all numbers of periods.
    """
    reach = float(np.ptp(series.at))
    max_periods = len(np.unique(series.at)) / MIN_ROWS
    periods = np.arange(MIN_PERIODS, max_periods, STEP)
    squares = float(series.z @ series.z)
    if not len(periods) or reach <= 0.0:
        return squares, 1.0
    time = (series.at - series.at[0]) / reach
    coarse = np.array([coarsely(count * time % 1.0) for count in periods])
    best = max(
        explained((count + change) * time % 1.0)
        for count in periods[np.argsort(-coarse)[:REFINED]]
        for change in FINE_STEPS
    )
    return squares - best, max(1.0, max_periods - MIN_PERIODS)
