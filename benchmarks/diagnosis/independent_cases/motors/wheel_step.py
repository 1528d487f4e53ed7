"""Motion of wheels over a short time: exact in the linear part, mid-point rule in the rest, true stick and slip."""

import numpy as np

from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, angle_torque, current, dry_friction
from benchmarks.diagnosis.independent_cases.recipes import Array


def _settling_rate(p: Lanes, u: Array) -> Array:
    """Return the rate (1/s) at which the linear part of the motor settles."""
    return (p.K**2 / (p.R + p.source * (u / p.U) ** 2) + p.B) / p.J


def advance(p: Lanes, u: Array, w: Array, angle: Array, *, h: float, torque: Array | float = 0.0) -> Array:
    """Return the speeds (rad/s) after h seconds; see `moved`."""
    return moved(p, u, w, angle, h=h, torque=torque)[0]


def moved(p: Lanes, u: Array, w: Array, angle: Array, *, h: float, torque: Array | float = 0.0) -> tuple[Array, Array]:
    """Return the speeds (rad/s) after h seconds at voltage u (V) from speed w, and the mean speeds until then.

    p is one column of the lanes, and `torque` (N m) pushes forward. A wheel at rest stays while the drive torque is
    within the breakaway torque. A wheel that reaches zero within the step stops there, and starts again only if the
    drive torque exceeds that. Both speeds are exact where the motor is linear beside Coulomb friction.
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
    target = (after - w * (1 - gone)) / gone
    mean = (w * gone / slope + target * (h - gone / slope)) / h
    crossing = ~rest & (after * w < 0)
    if crossing.any():
        # From w towards the target as exp(-slope t) until the speed is zero, then from rest for the time that is left.
        until = np.log1p(np.divide(-w, target, out=np.zeros_like(after), where=crossing)) / slope
        left = h - until
        direction = np.sign(drive)
        start = np.where(stuck, 0.0, (drive - direction * dry_friction(p, 0.0, direction)) / p.J)
        again = start * -np.expm1(-slope * left) / slope
        turned = target * until + w / slope + (start * left - again) / slope
        after, mean = np.where(crossing, again, after), np.where(crossing, turned / h, mean)
    return after, mean
