"""Loads on the wheels of a drive that come with its turning, and which no effect of the list describes.

Tyres and casters move sideways in a turn. What that takes, the motors deliver in addition to their friction, and a
model of each wheel alone does not know of it. The loads are rivals of the names (`diagnosis.inference.unexplained`):
an effect of the list, or several together, can imitate a part of them.
"""

from collections.abc import Iterator

import numpy as np

from symolo.core.arrays import Array

TURNING = "turn_rad_s"
"""Name of the covariate with the rate of turning."""
MIN_TURN = 0.1
"""Smallest difference of the wheels' speeds that counts as a turn, as a share of the largest speed."""
ABRUPT = 0.02
"""Share of the largest speed or rate at which a friction has three quarters of its size."""


def turning_loads(speed_rad_s: Array) -> Iterator[tuple[str, Array]]:
    """Yield what each load is, and its torque on the wheels (..., 2), relative to its largest one.

    Nothing is yielded if the robot hardly turns: such a drive says nothing about turns.

    Args:
        speed_rad_s: (..., 2), speeds of the right and the left wheel.
    """
    turn = speed_rad_s[..., :1] - speed_rad_s[..., 1:]
    if np.abs(turn).max(initial=0.0) <= MIN_TURN * np.abs(speed_rad_s).max(initial=0.0):
        return
    turn, speed = turn / np.abs(turn).max(), speed_rad_s / np.abs(speed_rad_s).max()
    against_turn = np.array([-1.0, 1.0])
    yield "friction of a wheel that grows in turns", -np.abs(turn) * np.tanh(speed / ABRUPT)
    yield "torque against the turn, in proportion to its rate", against_turn * turn
    yield "friction against the turn", against_turn * np.tanh(turn / ABRUPT)
