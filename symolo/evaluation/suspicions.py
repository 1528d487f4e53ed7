"""Suspicious properties of estimates: other units, another frame, axis or point of the robot, or another clock.

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
_ALIKE_M = 1e-3
"""Difference of two ATE up to which they do not show which of two changes is the likelier one."""
_MIN_POINT_M, _MIN_SHIFT_S = 0.02, 0.1
"""Smallest distance of another point from the middle of the axle, and smallest shift of times, that are reported."""
_MAX_SHIFT, _LIKELY_WITHIN = 0.3, 0.65
"""Largest shift of times as a share of the run, and the share of the poses that must be within the run after it."""
_COMPARED_POSES, _COMPARED_SHIFTS = 400, 1201
"""Largest numbers of poses and of shifts that are compared, which are all of those of a run of 100 s at 20 Hz."""
_MIN_OFFSET_DEG = 5
"""Smallest constant angle of headings that are counted clockwise which is stated."""
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


def suspicions(estimate: Estimate, t_s: Array, truth: Array) -> Iterator[str]:
    """Yield a sentence for each frame, axis, point or clock that seems to be another one than that of the true poses.

    Args:
        estimate: The estimates at their rows, not aligned.
        t_s: (N,), times of all rows.
        truth: (N, 3), true poses of all rows.
    """
    pose, true = estimate.pose, truth[estimate.rows]
    if len(pose) < _MIN_POSES or _spread(true) < _MIN_PATH_M or _spread(pose) == 0.0:
        return
    error = _rms(pose - true)
    movement = best_movement(pose[:, :2], true[:, :2]) or Movement(0.0, 0.0, 0.0)
    aligned = movement.applied(estimate).pose
    mirrored = _aligned_rms(pose * [1.0, -1.0, 1.0], true)
    if mirrored < MUCH_BETTER * min(error, _rms(aligned - true)):
        would_be = f"ATE would be {mirrored:.3f} m in place of {error:.3f} m"
        yield f"{would_be} with the other sign of y: the y axis may point to the right"
    else:
        frame = _frame(pose, true, movement, aligned)
        other = min(_clock(estimate, t_s, truth), _point(pose, true))
        if _spread(pose - true) <= other[0] + _ALIKE_M:
            other = (np.inf, "")  # one shift in W explains as much, as in a straight drive
        left, change = frame if frame[0] <= other[0] + _ALIKE_M else other
        if left < MUCH_BETTER * error:
            yield f"ATE would be {left:.3f} m in place of {error:.3f} m {change}"
        yield from _clockwise(aligned[:, 2], true[:, 2])
    turned = wrapped(aligned[:, 2] - true[:, 2])
    offset = _mean_angle(turned)
    if abs(offset) > _MIN_WRONG_RAD and _deviation(turned) < MUCH_BETTER * abs(offset):
        yield (
            f"the headings differ from the true ones by a constant {_whole_deg(offset)} deg: they may be those of"
            " another axis than x of the robot, which points forward"
        )


def _frame(pose: Array, true: Array, movement: Movement, aligned: Array) -> tuple[float, str]:
    """Return the ATE [m] after the best movement, infinite if that is small, and a text about it."""
    is_far = np.hypot(*(pose - true)[:, :2].mean(axis=0)) > _MIN_SHIFT_M or abs(movement.yaw_rad) > _MIN_TURN_RAD
    left = _rms(aligned - true) if is_far else np.inf
    return left, f"after {movement}: the estimates may be in another frame"


def _clock(estimate: Estimate, t_s: Array, truth: Array) -> tuple[float, str]:
    """Return the smallest ATE [m] after a shift of all times, infinite if no shift is likely, and a text about it.

    Places of a point ahead of the axle look like late times, but a shift of their times makes the headings worse.
    """
    step_s = float(np.median(np.diff(t_s))) if len(t_s) > 1 else 1.0
    max_rows = int(_MAX_SHIFT * len(t_s))
    chosen = np.unique(np.linspace(0, len(estimate.rows) - 1, _COMPARED_POSES).astype(np.int64))
    pose, rows = estimate.pose[chosen], estimate.rows[chosen]
    best = (np.inf, 0, np.inf)
    for shift in np.unique(np.linspace(-max_rows, max_rows, _COMPARED_SHIFTS).astype(np.int64)):
        within = (rows + shift >= 0) & (rows + shift < len(t_s))
        if abs(shift) * step_s >= _MIN_SHIFT_S and within.mean() >= _LIKELY_WITHIN:
            difference = pose[within] - truth[rows[within] + shift]
            best = min(best, (_rms(difference), int(shift), _rms_angle(difference[:, 2])))
    left, shift, turn_rad = best
    is_better = turn_rad <= _rms_angle((pose - truth[rows])[:, 2])
    by = f"subtracting {-shift * step_s:.2f} s from" if shift < 0 else f"adding {shift * step_s:.2f} s to"
    text = f"after {by} the times: they may count from another moment than the first row"
    return left if is_better else np.inf, text


def _point(pose: Array, true: Array) -> tuple[float, str]:
    """Return the ATE [m] after a constant shift in the frame of the robot, infinite if that is small, and a text."""
    c, s = np.cos(true[:, 2]), np.sin(true[:, 2])
    x, y = (pose - true)[:, :2].T
    forward_m, left_m = c * x + s * y, c * y - s * x
    ahead, aside = float(forward_m.mean()), float(left_m.mean())
    left = float(np.hypot(forward_m.std(), left_m.std())) if np.hypot(ahead, aside) > _MIN_POINT_M else np.inf
    places = [f"{abs(ahead):.3f} m {'ahead of' if ahead > 0 else 'behind'}"] if abs(ahead) > 0.1 * abs(aside) else []
    places += (
        [f"{abs(aside):.3f} m to the {'left' if aside > 0 else 'right'} of"] if abs(aside) > 0.1 * abs(ahead) else []
    )
    return (
        left,
        f"for a point of the robot {' and '.join(places)} the middle of its axle: the places may be those of it",
    )


def _clockwise(yaw_rad: Array, true_rad: Array) -> Iterator[str]:
    """Yield a sentence if the headings agree much better with the other sign, maybe less a constant angle."""
    deviation, changed = _deviation(yaw_rad - true_rad), _deviation(-yaw_rad - true_rad)
    if deviation > _MIN_WRONG_RAD and changed < MUCH_BETTER * deviation:
        offset_deg = _whole_deg(_mean_angle(true_rad + yaw_rad))
        change = (
            f"as {offset_deg} deg less the heading" if abs(offset_deg) >= _MIN_OFFSET_DEG else "with the other sign"
        )
        yield (
            f"the headings would spread by {np.degrees(changed):.1f} deg around the true ones in place of"
            f" {np.degrees(deviation):.0f} deg {change}: they may be counted clockwise"
        )


def _spread(pose: Array) -> float:
    """Return the root mean square distance [m] of places from their middle."""
    return _rms(pose - pose.mean(axis=0))


def _rms(difference: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(difference[:, :2] ** 2, axis=1))))


def _aligned_rms(pose: Array, true: Array) -> float:
    movement = best_movement(pose[:, :2], true[:, :2]) or Movement(0.0, 0.0, 0.0)
    return _rms(movement.applied(Estimate(np.arange(len(pose)), pose.copy(), None)).pose - true)


def _whole_deg(angle_rad: float) -> int:
    """Return an angle as whole degrees, above -180."""
    return -((180 - round(float(np.degrees(angle_rad)))) % 360 - 180)


def _rms_angle(angles_rad: Array) -> float:
    return float(np.sqrt(np.mean(wrapped(angles_rad) ** 2)))


def _mean_angle(angles_rad: Array) -> float:
    return float(np.angle(np.exp(1j * angles_rad).mean()))


def _deviation(angles_rad: Array) -> float:
    """Return the circular standard deviation [rad] of angles, whatever their mean."""
    length = float(np.abs(np.exp(1j * angles_rad).mean()))
    return float(np.sqrt(-2 * np.log(max(length, 1e-12)))) if length < 1.0 else 0.0
