"""Driving a curve path, and from its end onto the line at whatever angle the two meet."""

import math
from enum import Enum, auto

from configs.schema.controller import Avoidance, CurveAvoidance
from physics.control.avoidance import PathFollower
from physics.control.base import Observation, sign_of
from physics.control.bends import CurvePass, CurvePaths
from physics.control.facing import ObstacleFacing
from symolo.core.geometry.poses import PlanarPose

FULL_SEARCH_RAD = math.radians(200.0)
"""Turn on the spot after which the search for a line that was crossed is given up."""

IN_THE_MIDDLE = 2.2
"""Line error below which the turn into the line ends [channels]."""


class _CurvePhase(Enum):
    FACE = auto()
    PATH = auto()
    CROSS = auto()
    TURN = auto()
    DONE = auto()


class CurveFollower:
    """Face the obstacle, follow the path, drive straight until the axle is over the line, turn on the spot into it.

    A robot that has passed an obstacle on its left meets the line from the left and continues along it by turning left,
    at whatever angle it arrives.
    """

    def __init__(self, curves: CurvePaths, chosen: CurvePass, start: PlanarPose, config: Avoidance) -> None:
        if config.curves is None:
            raise ValueError("a curve path without settings for curves")
        self._config = config
        self._curves: CurveAvoidance = config.curves
        self._path = curves.paths[chosen.variant, chosen.bend]
        self._follower = PathFollower(self._path, start, config.look_ahead_m)
        self._turn = sign_of(chosen.side)
        self._facing = ObstacleFacing(config.curves.face, config.front_below_m, start, chosen.bend, chosen.near_m)
        self._phase = _CurvePhase.FACE
        self._line_seen_at: PlanarPose = start
        self._met_error = 0.0
        """Line error at the place where the line was met."""
        self._since: PlanarPose = start
        """Pose by odometry at which the present phase began."""

    @property
    def finished(self) -> bool:
        return self._phase is _CurvePhase.DONE

    def step(self, seen: Observation, line_error: float | None) -> tuple[float, float]:
        """Return the forward speed [m/s] and yaw rate [rad/s] for this tick; `line_error` is None without a line."""
        odometry = seen.odometry
        facing = self._facing.step(seen)
        if (next_phase := self._next_phase(odometry, line_error)) is not self._phase:
            self._phase, self._since = next_phase, odometry
            self._line_seen_at, self._met_error = odometry, line_error or 0.0
            if next_phase is _CurvePhase.PATH:
                self._follower = PathFollower(self._path, odometry, self._config.look_ahead_m)
        if line_error is not None:
            self._line_seen_at = odometry
        match self._phase:
            case _CurvePhase.FACE:
                return facing
            case _CurvePhase.PATH:
                return self._drive_path(odometry)
            case _CurvePhase.CROSS:
                return self._config.speed_m_s, 0.0
            case _CurvePhase.TURN | _CurvePhase.DONE:
                return 0.0, self._turn * self._curves.turn_rate_rad_s

    def _drive_path(self, odometry: PlanarPose) -> tuple[float, float]:
        bearing, rate = self._follower.bearing(odometry), self._curves.turn_rate_rad_s
        if abs(bearing) > self._curves.turn_above_rad:
            return 0.0, math.copysign(rate, bearing)
        curvature = self._follower.step(odometry, obstacle_beside=False)
        speed = min(self._config.speed_m_s, rate / max(abs(curvature), 1e-6))
        return speed, speed * curvature

    def _next_phase(self, odometry: PlanarPose, line_error: float | None) -> _CurvePhase:
        on_line = line_error is not None
        in_the_middle = line_error is not None and abs(line_error) < IN_THE_MIDDLE
        # A line on the side that the robot heads for is not crossed yet, or bends back under the robot.
        ahead = line_error is not None and self._turn * line_error <= -IN_THE_MIDDLE
        travelled_m = math.dist(odometry[:2], self._since[:2])
        since_line_m = math.dist(odometry[:2], self._line_seen_at[:2])
        match self._phase:
            case _CurvePhase.FACE if self._facing.done:
                return _CurvePhase.PATH
            case _CurvePhase.PATH if on_line and since_line_m > self._curves.line_after_m:
                return _CurvePhase.CROSS
            case _CurvePhase.PATH if self._follower.finished:
                return _CurvePhase.DONE
            case _CurvePhase.CROSS if travelled_m >= self._curves.cross_m * (4.0 if ahead else 1.0):
                # A line met at a small angle moves towards the middle; one that moves outwards lies across.
                came_in = line_error is not None and self._turn * (line_error - self._met_error) > 0.0
                return _CurvePhase.DONE if in_the_middle and came_in else _CurvePhase.TURN
            case _CurvePhase.TURN if in_the_middle or abs(odometry[2] - self._since[2]) > FULL_SEARCH_RAD:
                return _CurvePhase.DONE
            case _:
                return self._phase
