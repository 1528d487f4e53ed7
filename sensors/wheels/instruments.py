"""Readings of the motors' current sensor and tachometer; without effects they are exactly the true values.

The parameters of many robots may be stacked and are then broadcast against the readings (`physics.robot.stack`).
"""

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from physics.robot.model import applied
from symolo.core.arrays import Array, stacked_rows


def read_current_A(effects: RobotEffects, current_A: Array, since_on_s: Array) -> Array:
    """Return the readings of currents, of the same shape, at times since power-on, which broadcast to it."""
    gain = applied(effects.functions(Slot.CURRENT_GAIN), np.ones(()), since_on_s)
    reading = applied(effects.functions(Slot.CURRENT_READING), gain * current_A)
    return _with_error(effects, Slot.CURRENT_ERROR, reading, since_on_s)


def read_settled_speed_rad_s(effects: RobotEffects, speed_rad_s: Array, since_on_s: Array) -> Array:
    """Return the readings of speeds that have long been constant, so that lag and delay do not matter; same shape.

    Times since power-on broadcast to that shape.
    """
    gain = applied(effects.functions(Slot.SPEED_GAIN), np.ones(()), since_on_s)
    reading = applied(effects.functions(Slot.SPEED_READING), gain * speed_rad_s)
    return _with_error(effects, Slot.SPEED_ERROR, reading, since_on_s)


def _with_error(effects: RobotEffects, slot: Slot, reading: Array, since_on_s: Array) -> Array:
    """Return readings with the errors that are added to them."""
    functions = effects.functions(slot)
    return reading + applied(functions, np.zeros(()), since_on_s) if functions else reading


def read_speed_rad_s(effects: RobotEffects, t_s: Array, speed_rad_s: Array, since_on_s: Array | None = None) -> Array:
    """Return the readings (N, ...) at the times (N,) of the true speeds, which are linear between these times.

    Wheels are at rest until time 0. A log may begin later; that of the motor bench begins one row later.

    Args:
        effects: The robot's effects.
        t_s: (N,), times since the start of the trials.
        speed_rad_s: (N, ...), true speeds.
        since_on_s: Times since power-on, which broadcast to the speeds; those since the start by default.
    """
    if since_on_s is None:
        since_on_s = t_s.reshape(-1, *(1,) * (speed_rad_s.ndim - 1))
    if t_s[0] > 0.0:
        at_rest = np.zeros_like(speed_rad_s[:1])
        since_on_s = np.concatenate([since_on_s[:1], since_on_s])
        return read_speed_rad_s(effects, np.append(0.0, t_s), np.concatenate([at_rest, speed_rad_s]), since_on_s)[1:]
    if ripples := effects.functions(Slot.SPEED_RIPPLE):
        ratio = applied(ripples, np.ones(()), _angle_rad(t_s, speed_rad_s))
        speed_rad_s = ratio * speed_rad_s
    reading = read_settled_speed_rad_s(effects, speed_rad_s, since_on_s)
    for low_pass in effects.functions(Slot.SPEED_FILTER):
        rows = [reading[0]]
        for before, row, duration_s in zip(reading[:-1], reading[1:], np.diff(t_s).tolist(), strict=True):
            rows.append(low_pass(rows[-1], before, row, duration_s))
        reading = stacked_rows(rows)
    delay_s = applied(effects.functions(Slot.SPEED_DELAY), 0.0)
    return reading if np.all(delay_s == 0.0) else _earlier(reading, t_s, delay_s)


def _angle_rad(t_s: Array, speed_rad_s: Array) -> Array:
    """Return the angles (N, ...) since the first of the times (N,), of speeds that are linear between these times."""
    lasts_s = np.diff(t_s).reshape(-1, *(1,) * (speed_rad_s.ndim - 1))
    turns = 0.5 * lasts_s * (speed_rad_s[1:] + speed_rad_s[:-1])
    return np.concatenate([np.zeros_like(turns[:1]), np.cumsum(turns, axis=0)])


def _earlier(reading: Array, t_s: Array, delay_s: float | Array) -> Array:
    """Return the readings (N, ...) `delay_s` before the times (N,), linear between them and never before the first."""
    read_at_s = np.maximum(t_s.reshape(-1, *(1,) * (reading.ndim - 1)) - delay_s, t_s[0])
    after = np.clip(np.searchsorted(t_s, read_at_s), 1, len(t_s) - 1)
    after, share = np.broadcast_arrays(after, (read_at_s - t_s[after - 1]) / (t_s[after] - t_s[after - 1]))
    before, later = (np.take_along_axis(reading, index, axis=0) for index in (after - 1, after))
    return before + share * (later - before)
