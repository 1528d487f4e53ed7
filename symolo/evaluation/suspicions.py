"""Suspicious properties of estimates: other units, another frame, another axis of the robot.

Each is judged by how much better the estimates agree with the true poses after the change that is suspected.
"""

from collections.abc import Iterator

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import wrapped
from symolo.evaluation.alignment import Movement, best_movement
from symolo.evaluation.estimate import Estimate

MUCH_BETTER = 0.2
"""Share of an error that is left after a change from which on the change is suspected."""
_MIN_POSES = 10
_MIN_PATH_M = 0.05
"""Smallest root mean square distance of a path from its middle that shows a frame or a unit."""
_MIN_SHIFT_M, _MIN_TURN_RAD = 0.1, np.radians(5)
"""Smallest shift and turn of a frame that are reported."""
_MIN_WRONG_RAD = np.radians(20)
"""Smallest deviation of headings for which another unit or axis is suspected."""
_LENGTHS = (("millimetres", 1000.0), ("centimetres", 100.0))


def check_units(estimate: Estimate, truth: Array) -> None:
    """Refuse estimates that are in other units.

    Raises:
        InputError: They agree much better with the true poses (N, 3) of all rows in other units.
    """
    pose, true = estimate.pose, truth[estimate.rows]
    if len(pose) < _MIN_POSES:
        return
    if _spread(true) > _MIN_PATH_M and _spread(pose) > 0.0:
        for unit, per_m in _LENGTHS:
            if _aligned_rms(pose / [per_m, per_m, 1.0], true) < MUCH_BETTER * _spread(true):
                raise InputError(f"the places are probably {unit}", cure=f"divide them by {per_m:g}")
    deviation = _deviation(pose[:, 2] - true[:, 2])
    for unit, other, per in (("radians", "degrees", 180 / np.pi), ("degrees", "radians", np.pi / 180)):
        changed = _deviation(pose[:, 2] * per - true[:, 2])
        if deviation > _MIN_WRONG_RAD and changed < MUCH_BETTER * deviation:
            what = f"the headings are probably {unit}, and were taken for {other}"
            raise InputError(what, cure="correct the unit in the header, or convert them")


def suspicions(estimate: Estimate, truth: Array) -> Iterator[str]:
    """Yield a sentence for each frame or axis that seems to be another one than that of the true poses (N, 3)."""
    pose, true = estimate.pose, truth[estimate.rows]
    if len(pose) < _MIN_POSES or _spread(true) < _MIN_PATH_M or _spread(pose) == 0.0:
        return
    error = _rms(pose - true)
    movement = best_movement(pose[:, :2], true[:, :2]) or Movement(0.0, 0.0, 0.0)
    aligned = movement.applied(estimate).pose
    mirrored = _aligned_rms(pose * [1.0, -1.0, 1.0], true)
    is_far = np.hypot(*(pose - true)[:, :2].mean(axis=0)) > _MIN_SHIFT_M or abs(movement.yaw_rad) > _MIN_TURN_RAD
    if mirrored < MUCH_BETTER * min(error, _rms(aligned - true)):
        would_be = f"ATE would be {mirrored:.3f} m in place of {error:.3f} m"
        yield f"{would_be} with the other sign of y: the y axis may point to the right"
    elif is_far and _rms(aligned - true) < MUCH_BETTER * error:
        would_be = f"ATE would be {_rms(aligned - true):.3f} m in place of {error:.3f} m"
        yield f"{would_be} after {movement}: the estimates may be in another frame"
    turned = wrapped(aligned[:, 2] - true[:, 2])
    offset = _mean_angle(turned)
    if abs(offset) > _MIN_WRONG_RAD and _deviation(turned) < MUCH_BETTER * abs(offset):
        yield (
            f"the headings differ from the true ones by a constant {np.degrees(offset):.0f} deg: they may be those of"
            " another axis than x of the robot, which points forward"
        )


def _spread(pose: Array) -> float:
    """Return the root mean square distance [m] of places from their middle."""
    return _rms(pose - pose.mean(axis=0))


def _rms(difference: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(difference[:, :2] ** 2, axis=1))))


def _aligned_rms(pose: Array, true: Array) -> float:
    movement = best_movement(pose[:, :2], true[:, :2]) or Movement(0.0, 0.0, 0.0)
    return _rms(movement.applied(Estimate(np.arange(len(pose)), pose.copy(), None)).pose - true)


def _mean_angle(angles_rad: Array) -> float:
    return float(np.angle(np.exp(1j * angles_rad).mean()))


def _deviation(angles_rad: Array) -> float:
    """Return the circular standard deviation [rad] of angles, whatever their mean."""
    length = float(np.abs(np.exp(1j * angles_rad).mean()))
    return float(np.sqrt(-2 * np.log(max(length, 1e-12)))) if length < 1.0 else 0.0
