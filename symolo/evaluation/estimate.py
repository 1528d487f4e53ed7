"""Estimated poses of the robot: at times of their own, and at rows of data.csv."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import Ints


@dataclass(frozen=True)
class Estimate:
    """The poses that a method estimates at rows of a run."""

    rows: Ints
    """(M,), rows of data.csv with an estimate."""
    pose: Array
    """(M, 3), x [m], y [m], yaw [rad] in W."""
    covariance: Array | None
    """(M, 3, 3), covariance of the pose in W; None if the method states none."""

    def __post_init__(self) -> None:
        for array in (self.rows, self.pose, self.covariance):
            if array is not None:
                array.flags.writeable = False


@dataclass(frozen=True)
class EstimatedTrajectory:
    """The poses that a method estimates, at times of its own; anything that NumPy takes for an array may be given.

    Raises:
        InputError: Shapes do not agree, a number is not finite or too large, times do not increase, or a matrix is not
            a covariance matrix.
    """

    t_s: Array
    """(N,), increasing, since the first row of the run."""
    pose: Array
    """(N, 3), x [m], y [m], yaw [rad, wrapped or not] of the robot in W."""
    covariance: Array | None = None
    """(N, 3, 3), covariance of the pose in W; None if the method states none."""

    def __post_init__(self) -> None:
        count = np.size(self.t_s)
        shapes = {"t_s": (count,), "pose": (count, 3), "covariance": (count, 3, 3)}
        for name, shape in shapes.items():
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _checked(name, getattr(self, name), shape))
        if not count:
            raise InputError("an estimate without poses", cure="give at least one pose")
        check_size(self.t_s, self.pose, lambda i: f"pose {i}")
        late = np.flatnonzero(np.diff(self.t_s) <= 0.0)
        if len(late):
            i = int(late[0]) + 1
            what = f"t_s: time {i}, {self.t_s[i]:.9g} s, is not after {self.t_s[i - 1]:.9g} s"
            raise InputError(what, cure="sort the poses by time, each time once")
        if self.covariance is not None and (i := first_impossible(self.covariance)) is not None:
            raise InputError(
                f"covariance {i} is not a covariance matrix",
                got=self.covariance[i].tolist(),
                allowed=COVARIANCE_ALLOWED,
            )


MAX_TIME_S, MAX_POSE = 1e20, 1e8
"""Largest time, and largest number of a pose [m, rad]. Nanoseconds of Unix are about 1.8e18, and coordinates of maps,
such as the northing of UTM, up to 1e7 m. Squares of larger numbers may not be finite."""
_MIN_VARIANCE, _MAX_VARIANCE = 1e-18, 1e18
"""Limits of a variance [m2, rad2]."""
_MIN_EIGENVALUE = 1e-12
"""Smallest eigenvalue of the correlations; smaller ones consist of rounding errors."""
COVARIANCE_ALLOWED = (
    f"a symmetric matrix with positive eigenvalues, variances from {_MIN_VARIANCE:g} to {_MAX_VARIANCE:g}, and "
    "correlations between -1 and 1"
)


def check_size(t_s: Array, pose: Array, where_of: Callable[[int], str]) -> None:
    """Refuse numbers that are too large for errors to be computed.

    Args:
        t_s: (N,), times.
        pose: (N, 3), x [m], y [m], yaw [rad].
        where_of: Function that returns the place of a pose in the input, from its index.

    Raises:
        InputError: A number is too large.
    """
    columns = (
        ("t [s]", t_s, MAX_TIME_S),
        *zip(("x [m]", "y [m]", "heading [rad]"), pose.T, [MAX_POSE] * 3, strict=True),
    )
    for name, values, limit in columns:
        too_large = np.flatnonzero(np.abs(values) > limit)
        if len(too_large):
            i = int(too_large[0])
            raise InputError(name, where=where_of(i), got=float(values[i]), allowed=f"up to {limit:g}")


def first_impossible(covariance: Array) -> int | None:
    """Return the index of the first matrix of (N, 3, 3) that is no covariance of a pose; None if there is none."""
    variances = np.diagonal(covariance, axis1=1, axis2=2)
    is_in_range = ((variances >= _MIN_VARIANCE) & (variances <= _MAX_VARIANCE)).all(axis=1)
    # Entries beyond the limits could overflow below; they are refused also as the limits.
    bounded = np.clip(covariance, -_MAX_VARIANCE, _MAX_VARIANCE)
    is_symmetric = np.isclose(bounded, bounded.transpose(0, 2, 1), rtol=1e-6, atol=1e-15).all(axis=(1, 2))
    sd = np.sqrt(np.clip(variances, _MIN_VARIANCE, _MAX_VARIANCE))
    # Eigenvalues of correlations do not depend on the units, so that they show whether the matrix can be inverted.
    eigenvalues = np.linalg.eigvalsh(bounded / (sd[:, :, None] * sd[:, None, :]))
    wrong = np.flatnonzero(~is_in_range | ~is_symmetric | (eigenvalues[:, 0] < _MIN_EIGENVALUE))
    return int(wrong[0]) if len(wrong) else None


def _checked(name: str, values: Array, shape: tuple[int, ...]) -> Array:
    """Return a copy that nobody can change, of this shape and with finite numbers."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(name, got=values, allowed=f"numbers of the shape {shape}") from None
    if array.shape != shape:
        raise InputError(f"{name}: the shape {array.shape}", allowed=f"{shape}, as there are {shape[0]} times")
    if not np.isfinite(array).all():
        i = int(np.argwhere(~np.isfinite(array))[0][0])
        what = f"{name}: pose {i} has a number that is not finite"
        raise InputError(what, cure="leave out the times without an estimate")
    array.flags.writeable = False
    return array
