"""What current sensor and tachometer of the motors say, from what is true; without effects the same to the bit.

The numbers of many robots may be stacked, to be broadcast against the readings (`physics.robot.stack`).
"""

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from physics.robot.model import through
from symolo.core.arrays import Array


def read_current_A(effects: RobotEffects, current_A: Array) -> Array:
    """Of the same shape."""
    return through(effects.functions(Slot.CURRENT_READING), current_A)


def read_settled_speed_rad_s(effects: RobotEffects, speed_rad_s: Array) -> Array:
    """Of a speed that has stayed long enough for lag and delay not to matter; of the same shape."""
    return through(effects.functions(Slot.SPEED_READING), speed_rad_s)


def read_speed_rad_s(effects: RobotEffects, t_s: Array, speed_rad_s: Array) -> Array:
    """Readings (N, ...) at the times (N,) of the true speeds, which go on straight lines between them.

    Wheels stand still up to time 0. A log may begin later, as that of the motor bench does by one row.
    """
    if t_s[0] > 0.0:
        at_rest = np.zeros_like(speed_rad_s[:1])
        return read_speed_rad_s(effects, np.append(0.0, t_s), np.concatenate([at_rest, speed_rad_s]))[1:]
    reading = read_settled_speed_rad_s(effects, speed_rad_s)
    for low_pass in effects.functions(Slot.SPEED_FILTER):
        rows = [reading[0]]
        for before, row, duration_s in zip(reading[:-1], reading[1:], np.diff(t_s).tolist(), strict=True):
            rows.append(low_pass(rows[-1], before, row, duration_s))
        reading = np.stack(np.broadcast_arrays(*rows))
    delay_s = through(effects.functions(Slot.SPEED_DELAY), 0.0)
    return reading if np.all(delay_s == 0.0) else _earlier(reading, t_s, delay_s)


def _earlier(reading: Array, t_s: Array, delay_s: float | Array) -> Array:
    """Readings (N, ...) so much earlier than the times (N,), on lines between them and never before the first."""
    wanted_s = np.maximum(t_s.reshape(-1, *(1,) * (reading.ndim - 1)) - delay_s, t_s[0])
    after = np.clip(np.searchsorted(t_s, wanted_s), 1, len(t_s) - 1)
    after, share = np.broadcast_arrays(after, (wanted_s - t_s[after - 1]) / (t_s[after] - t_s[after - 1]))
    before, later = (np.take_along_axis(reading, index, axis=0) for index in (after - 1, after))
    return before + share * (later - before)
