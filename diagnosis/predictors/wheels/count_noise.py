"""The noise of mean speeds that are computed from whole counts, and the filter that makes it independent.

The error of a rounded count is in two successive mean speeds, with opposite signs. So these errors cancel out over many
rows: what lasts, such as a motor that is weaker by a thousandth, shows in the counts much more clearly than in as many
speeds with independent noise. A random torque does the opposite. It acts through the motor, whose speed follows with a
first-order lag, so that neighbouring speeds have its errors in common.

Both are one Gaussian process. Its covariance divides into factors, by which each speed becomes what the speeds before
do not predict of it (innovations; Kailath, IEEE Trans. Automatic Control 13 (1968) 646-655). The innovations of a model
that is right are also independent of all voltages so far, even if a controller computes these from the same counts. So
a fit to them has no bias by the loop (Ljung, System Identification, 2nd ed., section 13.4), which a fit to speeds with
noise that is taken as independent has.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky_banded, solve_banded

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

MIN_TORQUE_RATIO = 0.2
"""Lower limit of the standard deviation by the random torque, relative to that by the rounding. No model of a motor is
so right that only the counts round."""
KEEP_LIMITS = (1e-6, 1.0 - 1e-6)
"""Lower and upper limit of the share of its speed that a motor keeps from row to row."""
MAX_PERIODS = 1.5
"""Duration of a row in periods from which it has a gap before it."""
UNKNOWN = 1e6
"""Variance of a speed that is not known, relative to that of the others."""


@dataclass(frozen=True, eq=False)
class Whitening:
    """The filter for one level of the random torque."""

    sd: float
    """Standard deviation of a speed, as it is stated."""
    level: float
    """Standard deviation of a speed by rounding and torque, relative to `sd`."""
    keep: Array
    """(n,), share of a speed's error that the next one keeps; 0 at the beginning of a run of rows."""
    factor: Array
    """(3, n), the covariance's lower factor in the form of LAPACK's band matrices."""
    known: Mask
    """(n,), rows whose speed is known."""

    @property
    def predicted_sd(self) -> Array:
        """(n,), standard deviation of each speed if the speeds before it are known."""
        return np.asarray(self.factor[0])

    def undone(self, innovations: Array) -> Array:
        """Return the changes (n,) of speeds that have some innovations."""
        scaled = innovations / self.sd
        rest = self.factor[0] * scaled
        rest[1:] += self.factor[1, :-1] * scaled[:-1]
        rest[2:] += self.factor[2, :-2] * scaled[:-2]
        lag = np.stack([np.ones_like(rest), np.append(-self.keep[1:], 0.0)])
        return np.asarray(solve_banded((1, 0), lag, rest))

    def applied(self, speeds: Array) -> Array:
        """Return the innovations (..., n) of speeds or of their changes, with the standard deviation of a speed."""
        if not speeds.size:
            return speeds
        flat = speeds.reshape(-1, speeds.shape[-1])
        finite = np.where(self.known & np.isfinite(flat), flat, 0.0)
        rest = finite.copy()
        rest[:, 1:] -= self.keep[1:] * finite[:, :-1]
        innovations = self.sd * np.asarray(solve_banded((2, 0), self.factor, rest.T, check_finite=False)).T
        # A row without a prediction stays without one, and one without a reading may have any value.
        return np.where(np.isfinite(flat), innovations, flat).reshape(speeds.shape)


def continued(trial: NDArray[np.int64], holdout: Mask, lasts_s: Array, period_s: float) -> Mask:
    """Return whether each row (n,) continues the one before it, so that what one shows says something of the other.

    No row of the fit is compared with what held-out rows show. A row that lasts longer than the others, after a gap,
    keeps another share of the speed. It does not continue the row before it, nor does the next row continue it.

    Args:
        trial: (n,), trial of each row.
        holdout: (n,), rows that are held out.
        lasts_s: (n,), durations of the rows.
        period_s: Usual duration of a row.
    """
    is_long = lasts_s > MAX_PERIODS * period_s
    result = np.zeros(len(trial), dtype=bool)
    result[1:] = (np.diff(trial) == 0) & (holdout[1:] == holdout[:-1]) & ~is_long[1:] & ~is_long[:-1]
    return result


@dataclass(frozen=True, eq=False)
class CountNoise:
    """The noise of n mean speeds."""

    rounding: Array
    """(n,), standard deviation by the rounding of both counts."""
    goes_on: Mask
    """(n,), whether a row continues the one before it."""
    known: Mask
    """(n,), rows whose speed is known."""
    keep: float
    """Share of its speed that the motor keeps from row to row without a voltage."""
    stated: float
    """Standard deviation of a speed, as it is stated."""

    @classmethod
    def from_rounding(cls, rounding: Array, goes_on: Mask, known: Mask, keep: float, stated: float) -> "CountNoise":
        """Return the noise, whose parts are no more than what is stated."""
        largest = stated / np.hypot(1.0, MIN_TORQUE_RATIO)
        return cls(np.minimum(rounding, largest), goes_on, known, float(np.clip(keep, *KEEP_LIMITS)), stated)

    def torques(self, low: float, high: float, count: int) -> Array:
        """Return levels of the random torque with which a speed has `low` to `high` times the stated noise."""
        rounding = float(np.median(self.rounding))
        low, high = (max((x * self.stated) ** 2 - rounding**2, 0.0) ** 0.5 for x in (low, high))
        lowest = MIN_TORQUE_RATIO * rounding
        return np.geomspace(max(low, lowest), max(high, lowest), count)

    @property
    def torque(self) -> float:
        """Standard deviation by the random torque, if a speed has the stated noise."""
        return float(self.torques(1.0, 1.0, 1)[0])

    def response(self, loads: Array) -> Array:
        """Return the changes (n, k) of mean speeds by loads (n, k), each as the speed to which it leads in the end."""
        keep = np.where(self.goes_on, self.keep, 0.0)
        lag = np.stack([np.ones_like(keep), np.append(-keep[1:], 0.0)])
        ends = np.asarray(solve_banded((1, 0), lag, (1.0 - self.keep) * loads))
        before = np.where(self.goes_on[:, None], np.concatenate([np.zeros_like(ends[:1]), ends[:-1]]), 0.0)
        return self._mean_share * before + (1.0 - self._mean_share) * loads

    @property
    def _mean_share(self) -> float:
        """Mean share of its speed at the beginning of a row that a motor keeps in the row."""
        return float((self.keep - 1.0) / np.log(self.keep))

    def whitening(self, torque: float) -> Whitening:
        """Return the filter if a random torque gives speeds this standard deviation."""
        keep = np.where(self.goes_on, self.keep, 0.0)
        on = self.goes_on[1:]
        # A torque that is constant for a row moves the speed at its end by 1 - keep, and its mean by 1 - share.
        share = self._mean_share
        ends = (1.0 - self.keep) / (1.0 + self.keep)
        variance = share**2 * ends + (1.0 - share) ** 2
        next_to = share * (self.keep * share * ends + (1.0 - self.keep) * (1.0 - share)) / variance
        independent = self.rounding**2 + np.where(self.known, 0.0, UNKNOWN * self.stated**2)
        shared = np.where(on, -0.5 * self.rounding[1:] * self.rounding[:-1], 0.0)
        bands = np.zeros((3, len(independent)))
        # The covariance of speeds, each less what it keeps of the one before.
        bands[0] = independent + torque**2 * (1.0 + keep**2 - 2.0 * keep * next_to)
        bands[0, 1:] += keep[1:] ** 2 * independent[:-1] - 2.0 * keep[1:] * shared
        bands[1, :-1] = shared - keep[1:] * independent[:-1] + np.where(on, torque**2 * (next_to - self.keep), 0.0)
        bands[1, 1:-1] += keep[2:] * keep[1:-1] * shared[:-1]
        bands[2, :-2] = -keep[2:] * shared[:-1]
        level = float(np.hypot(torque, np.median(self.rounding))) / self.stated
        return Whitening(self.stated, level, keep, cholesky_banded(bands, lower=True), self.known)
