"""Movement of estimates in the plane so that they agree best with the true poses."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.evaluation.align import Align
from symolo.evaluation.estimate import Estimate


@dataclass(frozen=True)
class Movement:
    """A turn about the origin of W, and then a shift."""

    x_m: float
    y_m: float
    yaw_rad: float

    def __str__(self) -> str:
        x_m, y_m = round(self.x_m, 3) + 0.0, round(self.y_m, 3) + 0.0
        turn_deg = round(float(np.degrees(self.yaw_rad)), 1) + 0.0
        return f"a turn of {turn_deg:.1f} deg and a shift of ({x_m:.3f}, {y_m:.3f}) m"

    def applied(self, estimate: Estimate) -> Estimate:
        """Return the estimate, with its covariance, after the movement."""
        c, s = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        pose = estimate.pose @ turn.T + [self.x_m, self.y_m, self.yaw_rad]
        covariance = None if estimate.covariance is None else turn @ estimate.covariance @ turn.T
        return Estimate(estimate.rows.copy(), pose, covariance)


def alignment(align: Align, estimate: Estimate, truth: Array) -> Movement:
    """Return the movement that aligns an estimate with the true poses (N, 3) of all rows.

    Raises:
        InputError: It is that of all places, and all turns fit equally well, as for estimates at one place.
    """
    true = truth[estimate.rows]
    match align:
        case Align.NONE:
            return Movement(0.0, 0.0, 0.0)
        case Align.START:
            return _movement(float(true[0, 2] - estimate.pose[0, 2]), estimate.pose[0, :2], true[0, :2])
        case Align.SE2:
            movement = best_movement(estimate.pose[:, :2], true[:, :2])
            if movement is None:
                what = "the estimates cannot be aligned, because all turns fit equally well"
                raise InputError(what, cure="leave the alignment out")
            return movement


def best_movement(estimated: Array, true: Array) -> Movement | None:
    """Return the movement of places (M, 2) with the least squares of the distances from the true places (M, 2).

    This is the closed form of Umeyama (IEEE Transactions on Pattern Analysis and Machine Intelligence 13, 1991) in the
    plane, without a scale. It is None if all turns fit equally well, as for places that are all the same, or for the
    mirror image of a circle.
    """
    middle, true_middle = estimated.mean(axis=0), true.mean(axis=0)
    a, b = estimated - middle, true - true_middle
    along, across = float(np.sum(a * b)), float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    if np.hypot(along, across) <= 1e-6 * max(float(np.sum(b * b)), 1e-12):
        return None
    return _movement(float(np.arctan2(across, along)), middle, true_middle)


def _movement(yaw_rad: float, estimated: Array, true: Array) -> Movement:
    """Return the movement with this turn that brings one place to another."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    x, y = (true - np.array([c * estimated[0] - s * estimated[1], s * estimated[0] + c * estimated[1]])).tolist()
    return Movement(x, y, float(-((-yaw_rad + np.pi) % (2 * np.pi) - np.pi)))
