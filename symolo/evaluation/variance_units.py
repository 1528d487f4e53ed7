"""Stated variances that are probably standard deviations, or in another unit.

A factor of many tens between squared errors and variances that one usual mistake explains is suspicious; a filter that
is merely too confident, or too careful, is seldom wrong by just this factor.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import log, pi

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.tables.rows import wrapped
from symolo.evaluation.estimate import Estimate

_MIN_POSES = 10
_INCONSISTENT, _CONSISTENT = 30.0, 4.0
"""Factor by which squared errors differ from the variances, on average, from which on these are doubted, and that up to
which another meaning explains them."""
_DEG2_PER_RAD2 = (180 / pi) ** 2


@dataclass(frozen=True)
class _Meaning:
    """What the stated numbers may be in place of variances in m2, rad2 or deg2."""

    words: str
    cure: str
    factor: float
    power: int = 1

    def variances(self, stated: Array) -> Array:
        return self.factor * stated**self.power


_SQUARES = "standard deviations", "give their squares"
_PLACE = (
    _Meaning(*_SQUARES, 1.0, 2),
    _Meaning("in mm2", "divide them by 1e6", 1e-6),
    _Meaning("in cm2", "divide them by 1e4", 1e-4),
)
_HEADING = (
    _Meaning(*_SQUARES, 1.0, 2),
    _Meaning(*_SQUARES, _DEG2_PER_RAD2, 2),  # in deg, taken for deg2
    _Meaning("in deg2, and were taken for rad2", "correct the unit", 1 / _DEG2_PER_RAD2),
    _Meaning("in rad2, and were taken for deg2", "correct the unit", _DEG2_PER_RAD2),
)


def variance_suspicions(estimate: Estimate, truth: Array) -> Iterator[str]:
    """Yield a sentence for the variances of places, and for those of headings, if they are probably something else.

    Args:
        estimate: The estimates at their rows.
        truth: (N, 3), true poses of all rows.
    """
    if estimate.covariance is None or len(estimate.rows) < _MIN_POSES:
        return
    error = estimate.pose - truth[estimate.rows]
    error[:, 2] = wrapped(error[:, 2])
    stated = np.diagonal(estimate.covariance, axis1=1, axis2=2)
    yield from _suspicions("places", error[:, :2], stated[:, :2], _PLACE)
    yield from _suspicions("headings", error[:, 2:], stated[:, 2:], _HEADING)


def _suspicions(name: str, error: Array, stated: Array, meanings: Sequence[_Meaning]) -> Iterator[str]:
    """Yield a sentence if the stated variances (N, K) of errors (N, K) would be consistent by another meaning."""
    ratio = _ratio(error, stated)
    if not ratio or 1 / _INCONSISTENT <= ratio <= _INCONSISTENT:
        return
    meaning = min(meanings, key=lambda one: abs(log(_ratio(error, one.variances(stated)))))
    explained = _ratio(error, meaning.variances(stated))
    if 1 / _CONSISTENT <= explained <= _CONSISTENT:
        yield (
            f"the squared errors of the {name} are {ratio:.2g} times the stated variances on average, and would be"
            f" {explained:.2g} times if these numbers were {meaning.words}: {meaning.cure} if they are"
        )


def _ratio(error: Array, variance: Array) -> float:
    """Return the mean of the squared errors, each divided by its variance; about 1 if these are consistent."""
    return float(np.mean(error**2 / variance))
