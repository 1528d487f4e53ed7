"""The motion of a robot by its encoder counts, with wheels that differ a little from the drawing.

The state is x [m], y [m], yaw [rad] and three shares by which the robot may differ from its drawing: of the mean wheel
radius, of the difference between the two radii, and of the track. They do not change during a drive. A filter that has
them as states treats the error of odometry as a drift, not as noise, and can learn the drift.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.usual_tolerances import PAIR_SHARE, TRACK_SHARE, WHEEL_SHARE
from pipeline.baselines.robot_knowledge import SLIP_M_SQRT_M, RobotKnowledge, Start
from sensors.wheels.odometry import Odometry
from symolo.core.arrays import Array

STATES = 6
SHARES_SD = np.array([WHEEL_SHARE, PAIR_SHARE, TRACK_SHARE])
"""Standard deviations (3,) of the shares between robots of one drawing; the diagnosis assumes the same."""


@dataclass(frozen=True)
class WheelMotion:
    """The step from one row to the next and its uncertainty."""

    odometry: Odometry
    slip_m_sqrt_m: float = SLIP_M_SQRT_M
    """Standard deviation [m] of the random error of the distance that a wheel rolls, after 1 m."""

    @classmethod
    def from_knowledge(cls, knowledge: RobotKnowledge) -> "WheelMotion":
        """Return the motion of a robot by its drawing."""
        return cls(knowledge.drawing.odometry, knowledge.slip_m_sqrt_m)

    def slip_sd_m(self, rolled_m: Array) -> Array:
        """Return the standard deviation [m] of rolled distances, in the same shape."""
        return self.slip_m_sqrt_m * np.sqrt(np.abs(rolled_m))

    def moved(self, state: Array, rolled_m: Array) -> Array:
        """Return the states (..., 6) after the wheels have rolled the distances (..., 2) by the drawing, right and
        left.

        The mid-point rule of `sensors.wheels.odometry`, with the wheels and track of each state.
        """
        radius, pair, track = state[..., 3], state[..., 4], state[..., 5]
        right = rolled_m[..., 0] * (1.0 + radius + 0.5 * pair)
        left = rolled_m[..., 1] * (1.0 + radius - 0.5 * pair)
        forward, turn = 0.5 * (right + left), (right - left) / (self.odometry.track_m * (1.0 + track))
        middle = state[..., 2] + 0.5 * turn
        moved = state.copy()
        moved[..., 0] += forward * np.cos(middle)
        moved[..., 1] += forward * np.sin(middle)
        moved[..., 2] += turn
        return moved

    def jacobians(self, state: Array, rolled_m: Array) -> tuple[Array, Array]:
        """Return the derivatives of `moved` by one state, (6, 6), and by the distances, (6, 2), in closed form."""
        radius, pair, track = state[3:]
        wide = self.odometry.track_m * (1.0 + track)
        scale = np.array([1.0 + radius + 0.5 * pair, 1.0 + radius - 0.5 * pair])
        right, left = rolled_m * scale
        forward, turn = 0.5 * (right + left), (right - left) / wide
        middle = state[2] + 0.5 * turn
        ahead, across = np.array([np.cos(middle), np.sin(middle)]), np.array([-np.sin(middle), np.cos(middle)])

        def column(d_right: float, d_left: float, d_turn: float) -> Array:
            """Return the change of the pose by a change of the rolled distances and of the turn."""
            d_forward, d_turn = 0.5 * (d_right + d_left), d_turn + (d_right - d_left) / wide
            return np.array([*(d_forward * ahead + 0.5 * forward * d_turn * across), d_turn])

        by_state = np.eye(STATES)
        by_state[:2, 2] = forward * across
        by_state[:3, 3] = column(rolled_m[0], rolled_m[1], 0.0)
        by_state[:3, 4] = column(0.5 * rolled_m[0], -0.5 * rolled_m[1], 0.0)
        by_state[:3, 5] = column(0.0, 0.0, -turn / (1.0 + track))
        by_rolled = np.zeros((STATES, 2))
        by_rolled[:3, 0], by_rolled[:3, 1] = column(scale[0], 0.0, 0.0), column(0.0, scale[1], 0.0)
        return by_state, by_rolled


def rolled_distances_m(knowledge: RobotKnowledge) -> Array:
    """Return the distances (N, 2) [m] that the right and left wheel rolled since the row before, 0 at the first row."""
    steps = np.diff(knowledge.counts, axis=0, prepend=knowledge.counts[:1])
    return steps * knowledge.drawing.odometry.metres_per_count


def initial_state(start: Start) -> tuple[Array, Array]:
    """Return the state (6,) at the start and its covariance (6, 6), with the usual tolerances of the drawing."""
    return np.concatenate([start.pose, np.zeros(3)]), np.diag(np.concatenate([start.sd, SHARES_SD]) ** 2)
