"""The motion of the robot's body in space, for sensors that feel it."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array


def velocity_of_turn(w: Array, arm_m: Array) -> Array:
    """Return the velocity (3,) [m/s] w x r of a place at r (3,) [m] from the origin of a turn w (3,) [rad/s].

    It has the rounding of `np.cross`, which takes ten times as long for a single vector.
    """
    w_x, w_y, w_z = w.tolist()
    x, y, z = arm_m.tolist()
    return np.array([w_y * z - w_z * y, w_z * x - w_x * z, w_x * y - w_y * x])


@dataclass(frozen=True)
class BodyMotion:
    """Pose and velocity of R moved down to the floor; the body also pitches and rolls a little."""

    R_WR: Array
    """(3, 3), rotation of the body."""
    p_WR: Array
    """(3,) [m], origin: the point of the body on the floor below the middle of the axle."""
    v_WR: Array
    """(3,) [m/s], velocity of the origin in W."""
    w_WR: Array
    """(3,) [rad/s], angular velocity of the body in W."""
