"""Motion of wheels over a short time: exact in the linear part, mid-point rule in the rest, true stick and slip."""

import numpy as np

from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, angle_torque, current, dry_friction
from benchmarks.diagnosis.independent_cases.recipes import Array


def _settling_rate(p: Lanes, u: Array) -> Array:
    """Return the rate (1/s) at which the linear part of the motor settles."""
    return (p.K**2 / (p.R + p.source * (u / p.U) ** 2) + p.B) / p.J


def mean_speed(p: Lanes, u: Array, w: Array, after: Array, h: float) -> Array:
    """Return the mean speed (rad/s) over h seconds from speed w to `after`, exact where the motor is linear."""
    x = _settling_rate(p, u) * h
    gone = -np.expm1(-x)
    target = (after - w * (1 - gone)) / gone
    smooth = w * gone / x + target * (1 - gone / x)
    return np.where(w * after > 0, smooth, 0.5 * (w + after))


def advance(p: Lanes, u: Array, w: Array, angle: Array, *, h: float, torque: Array | float = 0.0) -> Array:
    """Return the speeds (rad/s) after h seconds at voltage u (V) from speed w; `torque` (N m) pushes forward.

    p is one column of the lanes. A wheel at rest stays while the drive torque is within the breakaway torque. A wheel
    that reaches zero within the step stops there, and starts again only if the drive torque exceeds that.
    """
    push = torque - angle_torque(p, angle)
    rest = w == 0
    drive = p.K * current(p, u, 0.0 * w) + push
    direction = np.where(rest, np.sign(drive), np.sign(w))
    stuck = np.abs(drive) <= dry_friction(p, 0.0, np.sign(drive))
    slope = _settling_rate(p, u)
    gone = -np.expm1(-slope * h)

    def acceleration(speed: Array) -> Array:
        friction = direction * dry_friction(p, np.abs(speed), direction)
        return (p.K * current(p, u, speed) - p.B * speed - friction + push) / p.J

    after = w + acceleration(w) * gone / slope
    if p.features:
        # Exponential mid-point rule: the linear part stays exact, the rest is taken at the middle of the step.
        middle = 0.5 * (w + after)
        middle = np.where(middle * direction < 0, 0.0, middle)
        after = w * (1 - gone) + (acceleration(middle) + slope * middle) * gone / slope
    after = np.where(rest & stuck, 0.0, after)
    crossing = ~rest & (after * w < 0)
    if crossing.any():
        left = h * (1 - w / np.where(crossing, w - after, 1.0))
        direction = np.sign(drive)
        start = (drive - direction * dry_friction(p, 0.0, direction)) / p.J
        again = start * -np.expm1(-slope * left) / slope
        after = np.where(crossing, np.where(stuck, 0.0, again), after)
    return after
