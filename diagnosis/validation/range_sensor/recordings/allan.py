"""Overlapping Allan deviation of evenly spaced readings (IEEE Std 952-1997, Annex C)."""

import numpy as np

from symolo.core.arrays import Array

MIN_GROUPS = 6
"""Fewest groups of the longest length that must fit into a recording; fewer give no useful average."""


def allan_deviation(readings: Array, lengths: tuple[int, ...]) -> Array:
    """Return the deviation of the means of neighbouring groups of n readings, over the root of two, (len(lengths),).

    For white noise of deviation s it is s / sqrt(n); a drift of r a reading gives r n / sqrt(2).
    """
    total = np.concatenate([[0.0], np.cumsum(readings - readings.mean())])
    deviations = []
    for n in lengths:
        mean = (total[n:] - total[:-n]) / n
        deviations.append(np.sqrt(0.5 * np.mean((mean[n:] - mean[:-n]) ** 2)))
    return np.array(deviations)


def group_lengths(count: int) -> tuple[int, ...]:
    """Return three group lengths to an octave, from one reading to the longest that `count` readings allow."""
    longest = max(1, count // MIN_GROUPS)
    powers = 2.0 ** (np.arange(3 * np.log2(longest) + 1) / 3.0)
    return tuple(sorted({int(n) for n in powers if n <= longest}))
