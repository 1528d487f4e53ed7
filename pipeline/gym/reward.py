"""Reward of an agent: by default for progress along the track, and for more by setting a weight."""

from collections.abc import Callable
from dataclasses import dataclass

from symolo.core.geometry.poses import PlanarPose


@dataclass(frozen=True)
class Outcome:
    """What happened in one step; only the environment knows it, the agent does not."""

    pose: PlanarPose
    """True pose X_WR at the end: x [m], y [m], yaw [rad]."""
    twist: tuple[float, float]
    """True forward speed [m/s] and yaw rate [rad/s] at the end."""
    progress_m: float
    """Displacement along the track, below 0 backwards."""
    off_track_m: float
    """Distance from the track at the end."""
    touched: tuple[str, ...]
    """Walls and obstacles that the robot touched."""
    lap_closed: bool
    """Whether this step closed the lap."""
    duration_s: float


@dataclass(frozen=True)
class Reward:
    """Weights of a reward; it is their sum with what happened in the step."""

    per_metre: float = 1.0
    """Reward of each metre along the track."""
    per_second: float = 0.0
    """Reward of each second, for example -0.01 so that the agent hurries."""
    per_metre_off_track: float = 0.0
    """Reward of each second and metre of distance from the track, for example -1."""
    touch: float = -1.0
    """Reward of a contact with a wall or an obstacle, which ends the episode."""
    lap: float = 1.0
    """Reward at the end of the lap."""
    within_m: float = 0.25
    """Distance from the track within which progress counts."""

    def __call__(self, outcome: Outcome) -> float:
        return (
            self.per_metre * outcome.progress_m
            + outcome.duration_s * (self.per_second + self.per_metre_off_track * min(outcome.off_track_m, 1.0))
            + self.touch * bool(outcome.touched)
            + self.lap * outcome.lap_closed
        )


RewardFunction = Callable[[Outcome], float]
