"""Association of estimates with rows of a run by their times."""

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.evaluation.estimate import Estimate, EstimatedTrajectory

MAX_GAP_S = 0.01
"""Default of the largest time between an estimate and its row, as in evo."""
_ROUNDING_S = 1e-9
_OTHER_UNITS = (
    ("milliseconds", 1e-3),
    ("microseconds", 1e-6),
    ("nanoseconds", 1e-9),
    ("seconds, and were taken for milliseconds", 1e3),
)
_MIN_WITHIN, _MIN_SPAN = 0.5, 0.05
"""Share of the estimates that are within the run, and of the run that they span, below which times are suspicious."""
_LIKELY_WITHIN, _LIKELY_SPAN, _LIKELY_SPAN_SHIFTED = 0.95, 0.5, 0.8
"""The same shares from which on another unit, or another origin, of the times is likely."""


def associated(trajectory: EstimatedTrajectory, t_s: Array, max_gap_s: float = MAX_GAP_S) -> Estimate:
    """Return each estimate at the row that is nearest in time, if that is at most `max_gap_s` away.

    If several estimates have the same nearest row, the one nearest to it is taken.

    Args:
        trajectory: The estimates.
        t_s: (N,), times of the rows of data.csv, increasing.
        max_gap_s: Largest time between an estimate and its row.

    Raises:
        InputError: No estimate has a row, or the times are likely in another unit or from another origin.
    """
    _check_times(trajectory.t_s, t_s, max_gap_s)
    rows = _nearest(trajectory.t_s, t_s)
    gap_s = np.abs(trajectory.t_s - t_s[rows])
    order = np.lexsort((gap_s, rows))
    order = order[gap_s[order] <= max_gap_s + _ROUNDING_S]
    chosen, first = np.unique(rows[order], return_index=True)
    taken = order[first]
    if not len(taken):
        what = f"no estimate is within {1000 * max_gap_s:g} ms of a row of data.csv"
        raise InputError(f"{what}: {_spans(trajectory.t_s, t_s)}", cure="give times since the first row of the run")
    covariance = None if trajectory.covariance is None else trajectory.covariance[taken].copy()
    return Estimate(chosen.astype(np.int64), trajectory.pose[taken].copy(), covariance)


def _nearest(times_s: Array, t_s: Array) -> np.ndarray:
    return np.searchsorted((t_s[1:] + t_s[:-1]) / 2, times_s)


def _check_times(times_s: Array, t_s: Array, max_gap_s: float) -> None:
    within, spanned = _fit(times_s, t_s, max_gap_s)
    if within >= _MIN_WITHIN and spanned >= _MIN_SPAN:
        return
    half_step_s = float(np.median(np.diff(t_s), axis=0)) / 2 if len(t_s) > 1 else max_gap_s
    for unit, factor in (("", 1.0), *_OTHER_UNITS):
        for origin_s in (0.0, float(times_s[0] * factor - t_s[0])):
            if not unit and not origin_s:
                continue
            shares = _fit(times_s * factor - origin_s, t_s, max(max_gap_s, half_step_s))
            needed = _LIKELY_SPAN_SHIFTED if origin_s else _LIKELY_SPAN
            is_better = shares[0] >= 2 * within or shares[1] >= 2 * spanned
            if shares[0] >= _LIKELY_WITHIN and shares[1] >= needed and is_better:
                raise InputError(_suspicion(unit, origin_s, times_s, t_s), cure=_cure(unit, factor, origin_s))


def _fit(times_s: Array, t_s: Array, max_gap_s: float) -> tuple[float, float]:
    """Return the share of the times that are within the run, and the share of the run between the first and last."""
    is_within = (times_s >= t_s[0] - max_gap_s) & (times_s <= t_s[-1] + max_gap_s)
    spanned_s = float(np.ptp(times_s[is_within])) if is_within.any() else 0.0
    return float(is_within.mean()), spanned_s / max(float(np.ptp(t_s)), max_gap_s, _ROUNDING_S)


def _suspicion(unit: str, origin_s: float, times_s: Array, t_s: Array) -> str:
    guesses = [f"are probably {unit}"] if unit else []
    guesses += ["probably count from another moment than the first row"] if origin_s else []
    return f"the times {' and '.join(guesses)}: {_spans(times_s, t_s)}"


def _cure(unit: str, factor: float, origin_s: float) -> str:
    steps = [f"multiply them by {factor:g}"] if unit else []
    steps += [f"subtract {origin_s:.9g} s"] if origin_s else []
    return " and ".join(steps)


def _spans(times_s: Array, t_s: Array) -> str:
    return f"they are from {times_s[0]:.9g} s to {times_s[-1]:.9g} s, and the run is from {t_s[0]:g} s to {t_s[-1]:g} s"
