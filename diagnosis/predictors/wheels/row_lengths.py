"""Time that each row of a drive lasts: the period of its grid, or what its logged times say if the counts agree."""

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import far_out
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.rows import good_values, joined, trial_of_rows
from symolo.core.arrays import Array

MIN_UNEVEN = 0.002
"""Root mean square deviation of the rows from the period, relative to it, below which times are even or rounded."""
MAX_SLOPE_ERROR = 0.125
"""Largest standard error of a slope that decides: a slope of 1 is then four of them above 0.5."""


def row_lengths_s(
    measurement: Measurement, grid: Grid, first: NDArray[np.int64], following: NDArray[np.int64]
) -> Array:
    """Return the time (m,) between two successive rows [s].

    The logged times may be uneven because the rows are, or because rows at even times were stamped late. A wheel turns
    further in a row that lasts longer, but not in one that was stamped late. So the counts decide: where they differ
    from the mean of the rows before and after, they are proportional to the difference of the logged times, with a
    slope of 1 if the rows are uneven and of 0 if they are not. The rows last whole periods unless the slope is above
    0.5, or where the counts are too few to decide.

    Args:
        measurement: The log.
        grid: Samples of its rows.
        first: (m,), rows before another one.
        following: (m,), the rows that follow them.
    """
    numbers, t_s = np.concatenate(grid.places), joined(trial.t_s for trial in measurement.trials)
    even_s = grid.period_s * (numbers[following] - numbers[first])
    logged_s = t_s[following] - t_s[first]
    uneven = logged_s / even_s - 1.0
    if not len(uneven) or np.sqrt(np.mean(uneven**2)) < MIN_UNEVEN:
        return even_s
    trial, same = trial_of_rows(measurement)[first], np.isclose(even_s, grid.period_s)
    usable = (trial[2:] == trial[:-2]) & same[2:] & same[1:-1] & same[:-2]
    rises, counted = [], []
    for side in ("left", "right"):
        counts = good_values(measurement, f"enc_{side}_ticks")
        turned = counts[following] - counts[first]
        difference = _from_neighbours(turned)
        is_good = usable & np.isfinite(difference) & ~far_out(difference)
        rises.append(_from_neighbours(turned * uneven)[is_good])
        counted.append(difference[is_good])
    return logged_s if _is_steep(np.concatenate(rises), np.concatenate(counted)) else even_s


def sample_lengths_s(grid: Grid, first: NDArray[np.int64], lasts_s: Array) -> float | Array:
    """Return the time from each sample of a grid to the next: the period, or (T - 1, N) if rows are uneven.

    Args:
        grid: Samples of the rows.
        first: (m,), rows before another one.
        lasts_s: (m,), time from each of them to the next row. Samples between both are evenly spread.
    """
    lengths = np.full((grid.samples - 1, len(grid.places)), grid.period_s)
    trial = np.repeat(np.arange(len(grid.places)), [len(place) for place in grid.places])
    sample = np.concatenate(grid.places)
    for row, lasts in zip(first.tolist(), lasts_s.tolist(), strict=True):
        between = slice(sample[row], sample[row + 1])
        lengths[between, trial[row]] = lasts / (sample[row + 1] - sample[row])
    return grid.period_s if np.allclose(lengths, grid.period_s, rtol=1e-9, atol=0.0) else lengths


def _from_neighbours(values: Array) -> Array:
    """Return the difference of each value from the mean of that before and that after it, (m - 2,)."""
    return values[1:-1] - 0.5 * (values[:-2] + values[2:])


def _is_steep(x: Array, y: Array) -> bool:
    """Return whether the slope of y over x, a line through 0, is known and above 0.5."""
    squares = float(x @ x)
    if not squares > 0.0:
        return False
    slope = float(x @ y) / squares
    # The scatter of y may depend on x, as it grows where the robot accelerates (White, Econometrica 48, 1980).
    error = float(np.sqrt((x**2) @ (y - slope * x) ** 2)) / squares
    return error < MAX_SLOPE_ERROR and slope > 0.5
