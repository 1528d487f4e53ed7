"""The likelihood of an offset that changes once, beside white noise: a fixture that was bumped."""

from dataclasses import dataclass

import numpy as np

from diagnosis.inference.unexplained.drift.elsewhere import Elsewhere
from diagnosis.inference.unexplained.drift.range_series import RangeSeries, each_path
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

JUMP_ROWS = 4
"""Rows at either end between which an offset may jump."""
MIN_SHARE = 1e-9
"""Share of an offset that the coordinates do not explain, below which it is only rounding error."""
MIN_LEVEL = 1e-9
"""Smallest variance of the noise, relative to that of the rows; a sensor at its limit has none."""
ROUNDS = 5
"""Estimates of the noise and of the best moment in turn. The noise decides how far the tolerances hold the numbers."""


@dataclass(frozen=True)
class Jump:
    """An offset that changes once, at the best moment."""

    cost: float
    """-2 log-likelihood, up to a constant that all models of the rows share."""
    z: Array
    """(n,), what is left of the residuals, in standard deviations of the noise beside the jump."""


def best_jump(series: RangeSeries, elsewhere: Elsewhere) -> Jump | None:
    """Return the most probable jump in one of the paths; None if there are too few rows.

    The coordinates of the fit move along, as far as their tolerances and other samples let them. The noise has its most
    probable size.

    Args:
        series: The residuals.
        elsewhere: What is known about the coordinates.
    """
    jumps = [_jump(series, elsewhere, inside) for inside in each_path(series)]
    return min((jump for jump in jumps if jump is not None), key=lambda jump: jump.cost, default=None)


def _jump(series: RangeSeries, elsewhere: Elsewhere, inside: Mask) -> Jump | None:
    """Return the most probable jump in the rows (n,) of one path."""
    count, places = len(series.at), np.flatnonzero(inside)[JUMP_ROWS:-JUMP_ROWS]
    if not len(places):
        return None
    offset = inside / series.sd_m
    columns = np.stack([offset, *(series.slopes_m / series.sd_m)])
    level, jump = max(float(series.z @ series.z) / count, MIN_LEVEL), None
    for _ in range(ROUNDS):
        information = columns @ columns.T / level
        information[1:, 1:] += elsewhere.information
        inverse = np.linalg.pinv(information, rcond=1e-12, hermitian=True)
        pull = columns @ series.z / level + [0.0, *elsewhere.pull]
        # The column of an offset from a row on, for each of the rows: its products are sums over the rows behind it.
        inner = _sums_behind(offset * columns)[:, places] / level
        along = _sums_behind(offset * series.z)[places] / level - inner.T @ inverse @ pull
        whole = _sums_behind(offset**2)[places] / level
        squares = whole - np.einsum("pk,pq,qk->k", inner, inverse, inner)
        # A coordinate of the fit, such as a limit that begins with a row, may be the same jump.
        is_new = squares > MIN_SHARE * whole
        sizes = np.divide(along, squares, out=np.zeros_like(along), where=is_new)
        best = int(np.argmax(along * sizes))
        size = sizes[best]
        change = inverse @ (pull - size * inner[:, best])
        rest = series.z - change @ columns - size * offset * (np.arange(count) >= places[best])
        level = max(float(rest @ rest) / count, MIN_LEVEL)
        cost = count * (np.log(level) + 1.0) + 2.0 * float(np.log(series.sd_m).sum())
        jump = Jump(float(cost + elsewhere.squares_after(change[1:])), rest / np.sqrt(level))
    return jump


def _sums_behind(values: Array) -> Array:
    """Return the sums (..., n) of values (..., n) from each row to the last one."""
    return np.cumsum(values[..., ::-1], axis=-1)[..., ::-1]
