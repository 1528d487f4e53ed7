"""Overlapping Allan deviation of evenly spaced readings (IEEE Std 952-1997, Annex C)."""

import numpy as np

from symolo.core.arrays import Array

SHORTEST_SPANS = 6
"""Longest averages are such that at least so many fit into the record; fewer say little."""


def allan_deviation(readings: Array, lengths: tuple[int, ...]) -> Array:
    """Deviation of the means of neighbouring groups of n readings, over the root of two, (len(lengths),).

    For white noise of deviation s it is s / sqrt(n); a drift of r a reading gives r n / sqrt(2).
    """
    total = np.concatenate([[0.0], np.cumsum(readings - readings.mean())])
    found = []
    for n in lengths:
        mean = (total[n:] - total[:-n]) / n
        step = mean[n:] - mean[:-n]
        found.append(np.sqrt(0.5 * np.mean(step**2)))
    return np.array(found)


def lengths_for(count: int) -> tuple[int, ...]:
    """Three group lengths to an octave, from one reading to the longest that `count` readings allow."""
    longest = max(1, count // SHORTEST_SPANS)
    powers = 2.0 ** (np.arange(3 * np.log2(longest) + 1) / 3.0)
    return tuple(sorted({int(n) for n in powers if n <= longest}))
