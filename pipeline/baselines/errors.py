"""The errors of an estimate and the consistency of its covariance: ATE, RPE and NEES.

ATE and RPE are those of Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012, and of Zhang
and Scaramuzza, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry", IROS 2018, in the
plane. Nothing is aligned: every method knows where it starts, so an alignment would only hide errors. NEES is that
of Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.4.
"""

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from pipeline.baselines.base import Estimate
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints, wrapped

OVER_S = 1.0
"""Time [s] between the poses of a pair."""
OVER_M = 1.0
"""Distance [m] along the path between the poses of a pair."""
TOLERANCE = 0.1
"""Relative tolerance of the distance between the poses of a pair, as in evo."""
SHARE = 0.95
"""Probability of the region of the estimates that is compared with the share of poses in it."""


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
    nees: float
    """Mean over the run divided by 3, its degrees of freedom: about 1 where the stated covariance is consistent,
    more where the method is overconfident."""
    within: float
    """Share of the poses whose truth lies in the method's own 95 % region."""


def errors_of(estimate: Estimate, t_s: Array, truth: Array) -> Errors:
    """Return the errors of an estimate against the true poses (N, 3) of all rows at the times (N,)."""
    true, estimated = truth[estimate.rows], estimate.pose
    off_m, off_rad = pose_errors(estimate, truth)
    seconds = pairs_by_time(t_s[estimate.rows], OVER_S)
    metres = pairs_by_distance(true, OVER_M)
    squares = nees(estimate, truth)
    return Errors(
        _rms(off_m),
        _rms(off_rad),
        float(np.median(off_m)),
        float(off_m.max()),
        float(off_m[-1]),
        *_relative(true, estimated, seconds),
        *_relative(true, estimated, metres),
        float(squares.mean() / 3),
        float(np.mean(squares <= chi2.ppf(SHARE, 3))),
    )


def pose_errors(estimate: Estimate, truth: Array) -> tuple[Array, Array]:
    """Return the distances from the true place [m] and the angles from the true heading [rad], (M,) each."""
    difference = estimate.pose - truth[estimate.rows]
    return np.hypot(*difference[:, :2].T), np.abs(wrapped(difference[:, 2]))


def nees(estimate: Estimate, truth: Array) -> Array:
    """Return the normalised estimation error squared of each pose, (M,).

    It follows chi-square with 3 degrees of freedom where the covariance is consistent.
    """
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
