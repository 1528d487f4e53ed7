"""Turning until an obstacle is straight ahead at a known distance, so that one stored path fits every encounter."""

import math
from enum import Enum, auto

from configs.schema.controller import FaceObstacle
from physics.control.base import Observation, Side, sign_of
from symolo.core.geometry.poses import PlanarPose


class _FacingPhase(Enum):
    BACK = auto()
    TURN_OUT = auto()
    SWEEP_IN = auto()
    FACE = auto()
    TRIM = auto()
    DONE = auto()


class ObstacleFacing:
    """Back off, sweep the front sensor over the obstacle, turn to its middle, then drive to the required distance."""

    def __init__(self, config: FaceObstacle, distance_m: float, start: PlanarPose, bend: Side, near_m: float) -> None:
        """Start facing an obstacle.

        Args:
            config: Speeds and limits.
            distance_m: Required final reading of the front sensor.
            start: Present pose by odometry.
            bend: Side to which the line bends; the obstacle lies there if it is not ahead.
            near_m: Reading of the sensor that detected the obstacle. The robot backs off if it is too near to turn.
        """
        self._config = config
        self._distance_m = distance_m
        self._inward = sign_of(bend)
        self._phase = _FacingPhase.BACK if near_m < config.back_below_m else _FacingPhase.TURN_OUT
        self._since = start
        self._sweep: list[tuple[float, float]] = []
        """Front reading [m] and yaw [rad] of each tick in which the obstacle was visible."""
        self._heading = start[2]

    @property
    def done(self) -> bool:
        return self._phase is _FacingPhase.DONE

    def step(self, seen: Observation) -> tuple[float, float]:
        """Return the forward speed [m/s] and yaw rate [rad/s] for this tick; zero when done."""
        if (next_phase := self._next_phase(seen)) is not self._phase:
            self._phase, self._since = next_phase, seen.odometry
        config = self._config
        match self._phase:
            case _FacingPhase.BACK:
                return -config.speed_m_s, 0.0
            case _FacingPhase.TURN_OUT:
                return 0.0, -self._inward * config.turn_rate_rad_s
            case _FacingPhase.SWEEP_IN:
                return 0.0, self._inward * config.turn_rate_rad_s
            case _FacingPhase.FACE:
                rate = config.face_gain_1_s * (self._heading - seen.odometry[2])
                return 0.0, max(-config.turn_rate_rad_s, min(config.turn_rate_rad_s, rate))
            case _FacingPhase.TRIM:
                return math.copysign(config.speed_m_s, seen.front_m - self._distance_m), 0.0
            case _FacingPhase.DONE:
                return 0.0, 0.0

    def _next_phase(self, seen: Observation) -> _FacingPhase:
        config, yaw = self._config, seen.odometry[2]
        visible = seen.front_m < config.seen_below_m
        travelled_m = math.dist(seen.odometry[:2], self._since[:2])
        turned_rad = abs(yaw - self._since[2])
        match self._phase:
            case _FacingPhase.BACK if travelled_m >= config.back_m:
                return _FacingPhase.TURN_OUT
            case _FacingPhase.TURN_OUT if not visible or turned_rad > config.max_out_rad:
                return _FacingPhase.SWEEP_IN
            case _FacingPhase.SWEEP_IN:
                return self._swept(seen, turned_rad)
            case _FacingPhase.FACE if abs(yaw - self._heading) < config.tolerance_rad:
                return _FacingPhase.TRIM
            case _FacingPhase.FACE if turned_rad > config.max_in_rad:
                return _FacingPhase.TRIM
            case _FacingPhase.TRIM if abs(seen.front_m - self._distance_m) < config.tolerance_m:
                return _FacingPhase.DONE
            case _FacingPhase.TRIM if travelled_m > config.max_trim_m:
                return _FacingPhase.DONE
            case _:
                return self._phase

    def _swept(self, seen: Observation, turned_rad: float) -> _FacingPhase:
        visible = seen.front_m < self._config.seen_below_m
        if visible:
            self._sweep.append((seen.front_m, seen.odometry[2]))
        over = bool(self._sweep) and not visible
        if not over and turned_rad < self._config.max_in_rad:
            return _FacingPhase.SWEEP_IN
        if self._sweep:
            # Near the edges the reading mixes with the background; the middle is where the reading is smallest.
            nearest_m = min(reading_m for reading_m, _ in self._sweep) + self._config.edge_m
            middle = [yaw for reading_m, yaw in self._sweep if reading_m <= nearest_m]
            self._heading = 0.5 * (middle[0] + middle[-1])
        else:
            self._heading = self._since[2]
        return _FacingPhase.FACE
