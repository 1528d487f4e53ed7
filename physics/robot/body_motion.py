"""The motion of the robot's body in space, for sensors that feel it."""

from dataclasses import dataclass

from symolo.core.arrays import Array


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
