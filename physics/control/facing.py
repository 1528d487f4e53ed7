"""Turning until an obstacle stands straight ahead at a known distance, so that one stored path fits every encounter."""

import math
from enum import Enum, auto

from configs.schema.robot import FaceObstacle
from physics.control.base import ControlInput, Pose, Side, sign_of


class _Phase(Enum):
    BACK = auto()
    TURN_OUT = auto()
    SWEEP_IN = auto()
    FACE = auto()
    TRIM = auto()
    DONE = auto()


class ObstacleFacing:
    """Back off, sweep the front sensor over the obstacle, turn to its middle, then drive to the distance asked for."""

    def __init__(self, config: FaceObstacle, distance_m: float, start: Pose, bend: Side, near_m: float) -> None:
        """Start facing an obstacle.

        Args:
            config: Speeds and limits.
            distance_m: Reading of the front sensor at which the obstacle is wanted.
            start: The robot's pose by odometry.
            bend: The side to which the line bends, on which the obstacle lies if it is not ahead.
            near_m: Reading of the sensor that has seen it; backs off where that is too near to turn.
        """
        self._config = config
        self._distance_m = distance_m
        self._inward = sign_of(bend)
        self._phase = _Phase.BACK if near_m < config.back_below_m else _Phase.TURN_OUT
        self._since = start
        self._sweep: list[tuple[float, float]] = []
        """Front reading [m] and yaw [rad] of every tick that saw the obstacle."""
        self._heading = start[2]

    @property
    def done(self) -> bool:
        return self._phase is _Phase.DONE

    def step(self, seen: ControlInput) -> tuple[float, float]:
        """Forward speed [m/s] and yaw rate [rad/s] for this tick; zero when done."""
        if (following := self._next_phase(seen)) is not self._phase:
            self._phase, self._since = following, seen.odometry
        config = self._config
        match self._phase:
            case _Phase.BACK:
                return -config.speed_m_s, 0.0
            case _Phase.TURN_OUT:
                return 0.0, -self._inward * config.turn_rate_rad_s
            case _Phase.SWEEP_IN:
                return 0.0, self._inward * config.turn_rate_rad_s
            case _Phase.FACE:
                rate = config.face_gain_1_s * (self._heading - seen.odometry[2])
                return 0.0, max(-config.turn_rate_rad_s, min(config.turn_rate_rad_s, rate))
            case _Phase.TRIM:
                return math.copysign(config.speed_m_s, seen.front_m - self._distance_m), 0.0
            case _Phase.DONE:
                return 0.0, 0.0

    def _next_phase(self, seen: ControlInput) -> _Phase:
        config, yaw = self._config, seen.odometry[2]
        visible = seen.front_m < config.seen_below_m
        travelled_m = math.hypot(seen.odometry[0] - self._since[0], seen.odometry[1] - self._since[1])
        turned_rad = abs(yaw - self._since[2])
        match self._phase:
            case _Phase.BACK if travelled_m >= config.back_m:
                return _Phase.TURN_OUT
            case _Phase.TURN_OUT if not visible or turned_rad > config.max_out_rad:
                return _Phase.SWEEP_IN
            case _Phase.SWEEP_IN:
                return self._swept(seen, turned_rad)
            case _Phase.FACE if abs(yaw - self._heading) < config.tolerance_rad:
                return _Phase.TRIM
            case _Phase.FACE if turned_rad > config.max_in_rad:
                return _Phase.TRIM
            case _Phase.TRIM if abs(seen.front_m - self._distance_m) < config.tolerance_m:
                return _Phase.DONE
            case _Phase.TRIM if travelled_m > config.max_trim_m:
                return _Phase.DONE
            case _:
                return self._phase

    def _swept(self, seen: ControlInput, turned_rad: float) -> _Phase:
        visible = seen.front_m < self._config.seen_below_m
        if visible:
            self._sweep.append((seen.front_m, seen.odometry[2]))
        over = bool(self._sweep) and not visible
        if not over and turned_rad < self._config.max_in_rad:
            return _Phase.SWEEP_IN
        if self._sweep:
            # Near its edges the reading mixes with what lies behind; the middle is where it is nearest.
            nearest_m = min(reading_m for reading_m, _ in self._sweep) + self._config.edge_m
            middle = [yaw for reading_m, yaw in self._sweep if reading_m <= nearest_m]
            self._heading = 0.5 * (middle[0] + middle[-1])
        else:
            self._heading = self._since[2]
        return _Phase.FACE
