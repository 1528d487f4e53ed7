"""The motion of a robot by its encoder counts, with wheels that differ a little from the drawing.

The state is x [m], y [m], yaw [rad] and three shares by which the robot may differ from its drawing: of the mean wheel
radius, of the difference between the two radii, and of the track. They stay what they are while it drives, so that a
filter that has them as states knows that odometry errs by a drift and not by noise, and can learn the drift.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.usual_tolerances import PAIR_SHARE, TRACK_SHARE, WHEEL_SHARE
from pipeline.baselines.robot_knowledge import RobotKnowledge, Start
from sensors.odometry import Odometry
from symolo.core.arrays import Array

STATES = 6
SHARES_SD = np.array([WHEEL_SHARE, PAIR_SHARE, TRACK_SHARE])
"""Between robots of one drawing, as the diagnosis takes them where nobody has measured better."""
SLIP_M_SQRT_M = 3e-4
"""Random error of a wheel's way, standard deviation after 1 m, its variance growing with the way (the form of Chong and
Kleeman, "Accurate odometry and error modelling for a mobile robot", ICRA 1997). The number is a usual one for rubber on
a clean floor: 0.3 mm."""


@dataclass(frozen=True)
class WheelMotion:
    """The step from one row to the next and its uncertainty."""

    odometry: Odometry

    def moved(self, state: Array, ways_m: Array) -> Array:
        """Return the states (..., 6) after the wheels have rolled the distances (..., 2) by the drawing, right and
        left.

        The mid-point rule of `sensors.odometry`, with the wheels and track of each state.
        """
        radius, pair, track = state[..., 3], state[..., 4], state[..., 5]
        right = ways_m[..., 0] * (1.0 + radius + 0.5 * pair)
        left = ways_m[..., 1] * (1.0 + radius - 0.5 * pair)
        forward, turn = 0.5 * (right + left), (right - left) / (self.odometry.track_m * (1.0 + track))
        middle = state[..., 2] + 0.5 * turn
        moved = state.copy()
        moved[..., 0] += forward * np.cos(middle)
        moved[..., 1] += forward * np.sin(middle)
        moved[..., 2] += turn
        return moved

    def jacobians(self, state: Array, ways_m: Array) -> tuple[Array, Array]:
        """Return the derivatives of `moved` by one state, (6, 6), and by the distances, (6, 2), in closed form."""
        radius, pair, track = state[3:]
        wide = self.odometry.track_m * (1.0 + track)
        scale = np.array([1.0 + radius + 0.5 * pair, 1.0 + radius - 0.5 * pair])
        right, left = ways_m * scale
        forward, turn = 0.5 * (right + left), (right - left) / wide
        middle = state[2] + 0.5 * turn
        ahead, across = np.array([np.cos(middle), np.sin(middle)]), np.array([-np.sin(middle), np.cos(middle)])

        def column(d_right: float, d_left: float, d_turn: float) -> Array:
            """Return the change of the pose by a change of the rolled distances and of the turn."""
            d_forward, d_turn = 0.5 * (d_right + d_left), d_turn + (d_right - d_left) / wide
            return np.array([*(d_forward * ahead + 0.5 * forward * d_turn * across), d_turn])

        by_state = np.eye(STATES)
        by_state[:2, 2] = forward * across
        by_state[:3, 3] = column(ways_m[0], ways_m[1], 0.0)
        by_state[:3, 4] = column(0.5 * ways_m[0], -0.5 * ways_m[1], 0.0)
        by_state[:3, 5] = column(0.0, 0.0, -turn / (1.0 + track))
        by_ways = np.zeros((STATES, 2))
        by_ways[:3, 0], by_ways[:3, 1] = column(scale[0], 0.0, 0.0), column(0.0, scale[1], 0.0)
        return by_state, by_ways


def ways(knowledge: RobotKnowledge) -> Iterator[Array]:
    """Return the distance (2,) [m] that each wheel rolled since the row before, right and left, by drawing and
    encoder.
    """
    yield from knowledge.steps * knowledge.drawing.odometry.metres_per_count


def slip_sd_m(ways_m: Array) -> Array:
    """Return the variance of the rolled distances, in the same shape."""
    return SLIP_M_SQRT_M * np.sqrt(np.abs(ways_m))


def begun(start: Start) -> tuple[Array, Array]:
    """Return the state (6,) at the start and its covariance (6, 6), with the usual tolerances of the drawing."""
    return np.concatenate([start.pose, np.zeros(3)]), np.diag(np.concatenate([start.sd, SHARES_SD]) ** 2)
