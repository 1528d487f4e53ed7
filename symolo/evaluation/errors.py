"""The errors of an estimate and the consistency of its covariance: ATE, RPE and NEES.

ATE and RPE are those of Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012, and of Zhang
and Scaramuzza, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry", IROS 2018, in the
plane. Nothing is aligned here. NEES is that of Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking
and Navigation, 2001, section 5.4.
"""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints, wrapped
from symolo.evaluation.estimate import Estimate

OVER_S = 1.0
"""Time [s] between the poses of a pair."""
OVER_M = 1.0
"""Distance [m] along the path between the poses of a pair."""
TOLERANCE = 0.1
"""Relative tolerance of the distance between the poses of a pair, as in evo."""
REGION_PROBABILITY = 0.95
"""Probability of the region of the estimates that is compared with the share of poses in it."""
_REGION_SQUARE = 7.814727903251179
"""Normalised square at the border of this region: quantile of chi-square with 3 degrees of freedom."""


@dataclass(frozen=True)
class Errors:
    """Errors of an estimate in one run; root mean squares unless the name says otherwise."""

    ate_m: float
    """Absolute trajectory error [m]."""
    ate_rad: float
    """Absolute error of the heading [rad]."""
    median_m: float
    """Median distance [m] from the true place."""
    worst_m: float
    """Largest distance [m] from the true place."""
    end_m: float
    """Distance [m] from the true place at the last pose."""
    rpe_per_s_m: float | None
    """Relative pose error [m] over one second; None where no two poses are so far apart."""
    rpe_per_s_rad: float | None
    rpe_per_m_m: float | None
    """Relative pose error [m] over one metre of the true path; None where no two poses are so far apart."""
    rpe_per_m_rad: float | None
    nees: float | None
    """Mean over the run divided by 3, its degrees of freedom: about 1 where the stated covariance is consistent,
    more where the method is overconfident; None if the method states no covariance."""
    within: float | None
    """Share of the poses whose truth lies in the method's own 95 % region; None as above."""
    poses: int
    """Number of estimated poses."""
    coverage: float
    """Share of the seconds of the run in which there is an estimate."""


def errors_of(estimate: Estimate, t_s: Array, truth: Array) -> Errors:
    """Return the errors of an estimate against the true poses (N, 3) of all rows at the times (N,)."""
    true, estimated = truth[estimate.rows], estimate.pose
    off_m, off_rad = pose_errors(estimate, truth)
    seconds = pairs_by_time(t_s[estimate.rows], OVER_S)
    metres = pairs_by_distance(true, OVER_M)
    squares = None if estimate.covariance is None else nees(estimate, truth)
    return Errors(
        _rms(off_m),
        _rms(off_rad),
        float(np.median(off_m)),
        float(off_m.max()),
        float(off_m[-1]),
        *_relative(true, estimated, seconds),
        *_relative(true, estimated, metres),
        None if squares is None else float(squares.mean() / 3),
        None if squares is None else float(np.mean(squares <= _REGION_SQUARE)),
        len(estimated),
        coverage(t_s[estimate.rows], t_s),
    )


def coverage(estimated_s: Array, t_s: Array) -> float:
    """Return the share of the seconds of a run with rows at the times (N,) in which there is an estimated time (M,)."""
    return len(np.unique(_second(estimated_s, t_s))) / len(np.unique(_second(t_s, t_s)))


def _second(times_s: Array, t_s: Array) -> Ints:
    """Return the number of the second of the run in which each time lies; the end of the run is in its last second."""
    seconds = np.floor(times_s - t_s[0] + 1e-9).astype(np.int64)
    return np.minimum(seconds, max(int(np.ceil(t_s[-1] - t_s[0] - 1e-9)) - 1, 0))


def pose_errors(estimate: Estimate, truth: Array) -> tuple[Array, Array]:
    """Return the distances from the true place [m] and the angles from the true heading [rad], (M,) each."""
    difference = estimate.pose - truth[estimate.rows]
    return np.hypot(*difference[:, :2].T), np.abs(wrapped(difference[:, 2]))


def nees(estimate: Estimate, truth: Array) -> Array:
    """Return the normalised estimation error squared of each pose, (M,).

    It follows chi-square with 3 degrees of freedom where the covariance is consistent.

    Raises:
        ValueError: The estimate has no covariance.
    """
    if estimate.covariance is None:
        raise ValueError("an estimate without a covariance has no NEES")
    error = estimate.pose - truth[estimate.rows]
    error[:, 2] = wrapped(error[:, 2])
    return np.einsum("ij,ij->i", error, np.linalg.solve(estimate.covariance, error[..., None])[..., 0])


def pairs_by_time(t_s: Array, apart_s: float) -> Ints:
    """Return the pairs (K, 2) of indices whose times (M,) differ by `apart_s`, to half a millisecond."""
    later = np.searchsorted(t_s, t_s + apart_s - 5e-4)
    first = np.flatnonzero(later < len(t_s))
    later = later[first]
    exact = np.abs(t_s[later] - t_s[first] - apart_s) < 5e-4
    return np.column_stack((first[exact], later[exact]))


def pairs_by_distance(pose: Array, apart_m: float) -> Ints:
    """Return pairs (K, 2) of indices: each pose (M, 3), and the later one whose distance along the path is nearest to
    `apart_m`, where that is within a tenth of it.
    """
    path_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(pose[:, :2], axis=0).T))])
    after = np.searchsorted(path_m, path_m + apart_m)
    choices = np.clip(np.stack([after - 1, after]), 0, len(path_m) - 1)
    wrong = np.abs(path_m[choices] - path_m - apart_m)
    best = wrong.argmin(axis=0)
    first = np.arange(len(path_m))
    later = choices[best, first]
    near = (wrong[best, first] <= TOLERANCE * apart_m) & (later > first)
    return np.column_stack((first[near], later[near]))


def _relative(true: Array, estimated: Array, pairs: Ints) -> tuple[float | None, float | None]:
    """Return the RPE of place [m] and heading [rad] over the pairs."""
    if not len(pairs):
        return None, None
    first, later = pairs.T
    moved, believed = _seen_from(true[first], true[later]), _seen_from(estimated[first], estimated[later])
    # The length of a difference is the same in any frame.
    return _rms(np.hypot(*(believed - moved)[:, :2].T)), _rms(wrapped((believed - moved)[:, 2]))


def _seen_from(here: Array, there: Array) -> Array:
    """Return the poses `there` (K, 3) in the frames of the poses `here`."""
    x, y, yaw = (there - here).T
    c, s = np.cos(here[:, 2]), np.sin(here[:, 2])
    return np.stack([c * x + s * y, c * y - s * x, yaw], axis=1)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
