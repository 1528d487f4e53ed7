"""The state machine: which behaviour drives the robot, and when another takes over.

configs/state_machine.yaml is the whole table. In each tick the first row whose condition holds is taken.
"""

import math

from physics.control.avoidance import PathFollower
from physics.control.base import Observation, RobotController, Side, Twist
from physics.control.bends import BendMemory, CurvePass, CurvePaths, curve_pass
from physics.control.conditions import ControlView
from physics.control.curves import CurveFollower
from physics.control.following import MAX_ERROR, follow, line_error, wall_error
from physics.control.paths import straight_path
from physics.control.transitions import load_transitions
from symolo.core.geometry.poses import PlanarPose
from symolo.dataset.codes import State

_AVOIDED_ON: dict[State, Side] = {State.AVOID_LEFT: "left", State.AVOID_RIGHT: "right"}


class BuiltIn(RobotController):
    """The controller of the paper, with the settings of `robot.controller`."""

    def start(self) -> None:
        config = self._config = self.robot.controller
        self._line_threshold = self.robot.line_sensor.threshold
        self._transitions = load_transitions()
        curves = config.avoidance.curves
        self._curves = CurvePaths.from_config(curves, config.avoidance.points) if curves else None
        self._bends = BendMemory(curves.memory_m, curves.straight_below_rad) if curves else None
        self._state = State.LINE
        self._return_state = State.LINE
        self._follower: PathFollower | CurveFollower | None = None
        self._entered_at: PlanarPose = (0.0, 0.0, 0.0)
        self._last_line_error = 0.0

    @property
    def state(self) -> State:
        return self._state

    def step(self, seen: Observation) -> Twist:
        """Choose the state for this tick and return its command."""
        error = line_error(seen.line, self._line_threshold)
        curve = self._curve_pass(seen)
        view = ControlView(seen, self._config, error, self._follower, self._return_state, curve)
        for row in self._transitions:
            if row.taken(self._state, view):
                self._enter(row.to, seen, curve)
                break
        if error is not None:
            self._last_line_error = error
        elif self._state is State.LINE:
            self.line_lost_count += 1
        v_m_s, w_rad_s = self._drive(seen, error)
        return Twist(v_m_s, w_rad_s, self._state)

    def _curve_pass(self, seen: Observation) -> CurvePass | None:
        if self._bends is None or self._state is not State.LINE:
            return None
        self._bends.update(seen.odometry)
        return curve_pass(seen, self._bends, self._config.avoidance)

    def _enter(self, state: State, seen: Observation, curve: CurvePass | None) -> None:
        if isinstance(self._follower, CurveFollower):
            # If the path ends without a line, the line is on the side of the obstacle.
            self._last_line_error = -MAX_ERROR if self._state is State.AVOID_LEFT else MAX_ERROR
        if self._curves is not None and curve is not None:
            self._return_state = self._state
            self._follower = CurveFollower(self._curves, curve, seen.odometry, self._config.avoidance)
        elif state in _AVOIDED_ON:
            self._return_state = self._state
            avoidance = self._config.avoidance
            path = straight_path(avoidance, _AVOIDED_ON[state])
            self._follower = PathFollower(path, seen.odometry, avoidance.look_ahead_m)
        else:
            self._follower = None
        self._state = state
        self._entered_at = seen.odometry

    def _drive(self, seen: Observation, error: float | None) -> tuple[float, float]:
        """Return the forward speed [m/s] and the yaw rate [rad/s]."""
        config = self._config
        match self._state:
            case State.LINE:
                return follow(self._last_line_error, config.line)
            case State.RIGHT_WALL:
                return follow(wall_error(seen.right_m, config.wall), config.wall.gains)
            case State.LEFT_WALL:
                return follow(-wall_error(seen.left_m, config.wall), config.wall.gains)
            case State.TURN_LEFT:
                return 0.0, config.corner.turn_rate_rad_s
            case State.TURN_RIGHT:
                return 0.0, -config.corner.turn_rate_rad_s
            case State.LOST_LEFT_WALL:
                return config.lost.speed_m_s, self._search_rate(seen)
            case State.LOST_RIGHT_WALL:
                return config.lost.speed_m_s, -self._search_rate(seen)
            case State.AVOID_LEFT | State.AVOID_RIGHT:
                return self._drive_path(seen, error)

    def _search_rate(self, seen: Observation) -> float:
        """Return the yaw rate [rad/s] towards the side of a lost wall."""
        lost = self._config.lost
        travelled_m = math.dist(seen.odometry[:2], self._entered_at[:2])
        return lost.gap_turn_rate_rad_s if travelled_m < lost.gap_m else lost.turn_rate_rad_s

    def _drive_path(self, seen: Observation, error: float | None) -> tuple[float, float]:
        if isinstance(self._follower, CurveFollower):
            return self._follower.step(seen, error)
        if self._follower is None:
            raise RuntimeError("avoiding without a path")
        obstacle_side: Side = "right" if self._state is State.AVOID_LEFT else "left"
        beside = seen.side_m(obstacle_side) < self._config.avoidance.behind_beyond_m
        speed = self._config.avoidance.speed_m_s
        return speed, speed * self._follower.step(seen.odometry, obstacle_beside=beside)
