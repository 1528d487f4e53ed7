"""Poses of a log at other times than those of its rows, with the noise of several rows averaged.

Interpolation between two rows averages their noise: half-way between them, a pose has half the variance of that at a
row. Predictions for a wrong delay of half a row would then fit better than those for the right one. A local regression
(Cleveland, J. Am. Stat. Assoc. 74 (1979) 829-836) over REACH_ROWS on either side has nearly the same noise at all
times, and less of it.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.measured.channel import Mask
from diagnosis.predictors.pose.delayed_pose import earlier
from diagnosis.predictors.rows import bridged
from symolo.core.arrays import Array

REACH_ROWS = 3.5
"""Distance in rows at which a row has no more weight. The parabola through the rows within 0.35 s at 20 rows per second
follows a robot that starts or ends a turn."""
NOISE_SHARE = 0.62
"""Standard deviation of a smoothed pose, relative to that of a row."""
ROWS = 8
"""Number of rows of which some have a weight."""
MIN_WEIGHT = 1e-9
"""Weight up to which a row does not count. At the edge of the reach, rounding errors alone would decide whether a row
has a weight, and rows without one determine no parabola."""
MIN_ROWS = 4
"""Smallest number of rows with a weight for a parabola, as many as there are at the start of a log."""


def smoothed_earlier(
    pose: Array, t_s: Array, trials: Sequence[int], delay_s: float | Array, trusted: Mask | None = None
) -> Array:
    """Return poses (..., n, k) a delay before the times of their rows, by a parabola through the rows around.

    Beside a gap, a parabola through too few rows, or through rows on one side, has more noise than a single row. Such a
    pose is interpolated.

    Args:
        pose: (n, k), poses of all trials, or some of their components.
        t_s: (n,), times of the rows.
        trials: Number of rows of each trial; a trial with fewer than ROWS is interpolated.
        delay_s: One delay, or (M, 1), or one for each row, (n,) or (M, n).
        trusted: (n,), rows that count; all by default. Between trusted rows, the others are interpolated.
    """
    if trusted is not None and not trusted.all():
        known = np.where(trusted[:, None], pose, np.nan)
        pose = bridged(known, t_s, trials)
    path = np.array(np.broadcast_to(earlier(pose, t_s, trials, delay_s), (*np.shape(delay_s)[:-1], *pose.shape)))
    delay_s = np.broadcast_to(delay_s, path.shape[:-1])
    begin = 0
    for rows in trials:
        part = slice(begin, begin + rows)
        begin += rows
        if rows < ROWS:
            continue
        times = t_s[part]
        delayed_s = np.clip(times - delay_s[..., part], times[0], times[-1])
        first = np.clip(np.searchsorted(times, delayed_s) - ROWS // 2, 0, rows - ROWS)
        around = first[..., None] + np.arange(ROWS)
        apart = (times[around] - delayed_s[..., None]) / np.median(np.diff(times))
        weight = np.maximum(1.0 - (apart / REACH_ROWS) ** 2, 0.0) ** 2
        weight = np.where(weight > MIN_WEIGHT, weight, 0.0)
        if trusted is not None:
            weight *= trusted[part][around]
        is_smoothed = np.count_nonzero(weight, axis=-1) >= MIN_ROWS
        powers = np.stack([np.ones_like(apart), apart, apart**2], axis=-1)
        weighted = weight[..., None] * powers
        # Two rows or fewer have a singular matrix.
        normal = np.where(is_smoothed[..., None, None], np.swapaxes(weighted, -1, -2) @ powers, np.eye(3))
        # The value of the parabola at the wanted time is its constant term.
        shares = np.linalg.solve(normal, np.swapaxes(weighted, -1, -2))[..., 0, :]
        # The sum of squares is the variance relative to that of a row. It is at most 1 at a row, since no other row has
        # a larger weight, and larger only where the parabola extrapolates or spans a gap.
        is_smoothed &= (shares**2).sum(axis=-1) <= 1.0
        smoothed = np.einsum("...j,...jk->...k", shares, pose[part][around])
        path[..., part, :] = np.where(is_smoothed[..., None], smoothed, path[..., part, :])
    return path
