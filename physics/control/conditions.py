"""Named conditions of the state machine's table, on what the robot senses and remembers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from configs.schema.controller import Controller
from physics.control.avoidance import PathFollower
from physics.control.base import Observation, Side, opposite
from physics.control.bends import CurvePass
from physics.control.curves import CurveFollower
from symolo.dataset.codes import State


@dataclass(frozen=True)
class ControlView:
    """Everything that conditions depend on: the input, the settings and the controller's memory."""

    seen: Observation
    config: Controller
    line_error: float | None
    follower: PathFollower | CurveFollower | None
    return_state: State
    curve: CurvePass | None
    """Curve path for the obstacle that is now in the way; None without an obstacle or without curve paths."""

    def on_line(self) -> bool:
        return self.line_error is not None

    def wall_found(self, side: Side) -> bool:
        return self.seen.side_m(side) < self.config.wall.found_within_m

    def line_ended_by_wall(self, side: Side) -> bool:
        return not self.on_line() and self.wall_found(side)

    def wall_lost(self, side: Side) -> bool:
        return self.seen.side_m(side) > self.config.wall.lost_beyond_m

    def wall_back(self, side: Side) -> bool:
        return not self.wall_lost(side)

    def wall_goes_on_opposite(self, side: Side) -> bool:
        return self.wall_lost(side) and self.wall_found(opposite(side))

    def obstacle_ahead(self, free_side: Side) -> bool:
        avoid = self.config.avoidance
        return self.seen.front_m < avoid.front_below_m and self.seen.side_m(free_side) >= avoid.free_side_beyond_m

    def curve_beside(self, side: Side) -> bool:
        return self.curve is not None and self.curve.side == side

    def corner_ahead(self) -> bool:
        return self.seen.front_m < self.config.corner.front_below_m

    def corner_turned(self, wall_side: Side) -> bool:
        return self.seen.front_m > self.config.corner.front_clear_m and self.wall_found(wall_side)

    def line_met_on_the_way_back(self) -> bool:
        is_returning = isinstance(self.follower, PathFollower) and self.follower.is_returning
        return is_returning and self.return_state is State.LINE and self.on_line()

    def avoided(self, into: State) -> bool:
        return self.follower is not None and self.follower.finished and self.return_state is into


@dataclass(frozen=True)
class Condition:
    """A condition that the table refers to by name."""

    arguments: tuple[str, ...]
    """Allowed values of its argument; empty if it takes none."""
    holds: Callable[[ControlView, str], bool]


SIDES = ("left", "right")
STATES = tuple(State.__members__)


def _plain(holds: Callable[[ControlView], bool]) -> Condition:
    return Condition((), lambda view, _: holds(view))


def _side_condition(holds: Callable[[ControlView, Side], bool]) -> Condition:
    return Condition(SIDES, lambda view, side: holds(view, "left" if side == "left" else "right"))


CONDITIONS: Mapping[str, Condition] = MappingProxyType(
    {
        "on_line": _plain(ControlView.on_line),
        "line_ended_by_wall": _side_condition(ControlView.line_ended_by_wall),
        "wall_lost": _side_condition(ControlView.wall_lost),
        "wall_back": _side_condition(ControlView.wall_back),
        "wall_goes_on_opposite": _side_condition(ControlView.wall_goes_on_opposite),
        "obstacle_ahead": _side_condition(ControlView.obstacle_ahead),
        "curve_beside": _side_condition(ControlView.curve_beside),
        "corner_ahead": _plain(ControlView.corner_ahead),
        "corner_turned": _side_condition(ControlView.corner_turned),
        "line_met_on_the_way_back": _plain(ControlView.line_met_on_the_way_back),
        "avoided": Condition(STATES, lambda view, state: view.avoided(State[state])),
    }
)
"""Conditions by name. The firmware has a function of the same name for each."""
