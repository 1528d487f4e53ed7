"""The Gymnasium environment: the agent is the controller of the robot of a scenario."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal, SupportsFloat

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from configs.draw import draw_run
from configs.loader import LoadedScenario, load_scenario
from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from physics.control.base import Command, Observation, Twist, Voltages
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.run.controller_runner import DriveKinematics
from pipeline.gym.reward import Outcome, Reward, RewardFunction
from pipeline.gym.top_view import TopView
from pipeline.gym.track import DrivingTrack
from pipeline.stages.closed_loop import ClosedLoop
from symolo.core.errors import InputError
from symolo.core.yaml.tree import Node

ActionKind = Literal["twist", "voltages"]
Readings = dict[str, NDArray[np.float32]]
_LARGEST_RANGE_M = 10.0
"""Largest range that the schema of the range sensors allows, also for no target."""


class DriveEnvironment(gymnasium.Env[Readings, NDArray[np.float32]]):
    """One run of a scenario is one episode, one control tick is one step.

    The observation is what the robot's controller learns: `line` (8,), `ranges` (3,) front, left and right [m],
    `odometry` (3,) x [m], y [m], yaw [rad] since the start, `wheels` (2,) turns of the wheels since the last step,
    right and left [rad], and one entry for each sensor of `robot.sensors`.

    The action is the twist (v [m/s], w [rad/s]) or the voltages of the motors (right, left [V]). An episode is
    terminated by a contact and by a closed lap, and truncated at the time limit of the scenario. `info` has the true
    pose and what the reward was computed from.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 20}

    def __init__(  # noqa: PLR0917 - gymnasium.make passes keywords
        self,
        scenario: str = "symolo",
        settings: Sequence[str] = (),
        route: str | None = None,
        action: ActionKind = "twist",
        reward: RewardFunction = Reward(),  # noqa: B008 - frozen
        render_mode: str | None = None,
    ) -> None:
        """Read the scenario.

        Args:
            scenario: Name of a shipped scenario, or path of a file.
            settings: Settings as of `--set`, such as `robot=worn` or `stop.time_limit_s=30`.
            route: Route of the scenario; by default the first one.
            action: Meaning of an action.
            reward: Weights, or any function of an `Outcome`.
            render_mode: `rgb_array` for an image of the arena from above, or None.

        Raises:
            InputError: The scenario is wrong, or has no such route.
        """
        self._loaded = load_scenario(scenario, settings)
        self._route = route or self._loaded.routes[0].name
        self._reward = reward
        self._within_m = reward.within_m if isinstance(reward, Reward) else Reward().within_m
        self._kind: ActionKind = action
        self.render_mode = render_mode
        self._loop: ClosedLoop | None = None
        self._run = 0
        self._top_view: TopView | None = None
        self._prepare(draw_run(self._loaded, self._route, 1))
        self._limits = _action_space(self._spec.robot, action)
        # Gymnasium declares types that its own spaces do not have.
        self.action_space = self._limits  # pyright: ignore[reportAttributeAccessIssue]
        self.observation_space = self._observed_space()  # pyright: ignore[reportAttributeAccessIssue]

    @property
    def spec_of_run(self) -> RunSpec:
        """Specification of the present episode."""
        return self._spec

    def reset(
        self,
        *,
        seed: int | None = None,
        options: dict[str, Any] | None = None,  # noqa: ARG002 - of the interface
    ) -> tuple[Readings, dict[str, Any]]:
        """Begin the next episode.

        With a seed it is run 1 of the scenario with this seed; without one, the next run of the same seed. Everything
        that the scenario draws is drawn again, so that an agent meets a different arena or robot in each episode.
        """
        super().reset(seed=seed)
        if seed is not None:
            self._loaded, self._run = _seeded(self._loaded, seed), 0
        self._run += 1
        self._close_loop()
        self._prepare(draw_run(self._loaded, self._route, self._run))
        self._loop = ClosedLoop(self._spec)
        self._tick = 0
        seen = self._loop.observe(0)
        self._pose = self._loop.world.pose()
        return self._read(seen), self._info(self._outcome(duration_s=0.0, touched=(), was_closed=False))

    def step(self, action: NDArray[np.float32]) -> tuple[Readings, SupportsFloat, bool, bool, dict[str, Any]]:
        """Drive until the next control tick.

        Raises:
            InputError: The action has not two finite numbers, or the episode has not begun.
        """
        loop = self._loop
        if loop is None:
            raise InputError("step", cure="call reset first")
        was_closed = loop.lap.closed
        loop.act(self._kinematics.decision(self._command(action)))
        self._tick += 1
        seen = loop.observe(self._tick)
        touched = loop.world.touching()
        outcome = self._outcome(1.0 / self._spec.rates.control_hz, touched, was_closed=was_closed)
        terminated = bool(touched) or (loop.lap.closed and self._spec.stop.lap)
        truncated = not terminated and self._tick >= self._spec.stop.time_limit_s * self._spec.rates.control_hz
        return self._read(seen), self._reward(outcome), terminated, truncated, self._info(outcome)

    def render(self) -> NDArray[np.uint8] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the arena from above with the robot, (480, 480, 3), if the render mode is `rgb_array`."""
        if self.render_mode != "rgb_array" or self._loop is None:
            return None
        if self._top_view is None:
            self._top_view = TopView(self._loop.arena, self._spec.robot)
        return self._top_view.image(self._loop.world.pose(), self._loop.world.time_s)

    def close(self) -> None:
        self._close_loop()

    def _prepare(self, spec: RunSpec) -> None:
        self._spec = spec
        self._kinematics = DriveKinematics(spec.robot)
        self._rad_per_count = 2.0 * np.pi / spec.robot.encoder.counts_per_revolution
        self._track: DrivingTrack | None = None
        self._top_view = None

    def _command(self, action: NDArray[np.float32]) -> Command:
        numbers = np.asarray(action, dtype=float)
        if numbers.shape != (2,) or not np.isfinite(numbers).all():
            raise InputError("action", got=str(action), allowed="two finite numbers")
        first, second = np.clip(numbers, self._limits.low, self._limits.high).tolist()
        return Twist(first, second) if self._kind == "twist" else Voltages(first, second)

    def _outcome(self, duration_s: float, touched: tuple[str, ...], *, was_closed: bool) -> Outcome:
        loop = self._loop
        assert loop is not None  # noqa: S101 - the callers have made it
        if self._track is None:
            self._track = DrivingTrack.from_spec(self._spec, loop.arena)
        pose, before = loop.world.pose(), self._pose
        self._pose = pose
        progress_m, off_track_m = self._track.progress_m(before, pose, self._within_m)
        closed = loop.lap.closed and not was_closed
        return Outcome(pose, loop.world.twist(), progress_m, off_track_m, touched, closed, duration_s)

    @staticmethod
    def _info(outcome: Outcome) -> dict[str, Any]:
        return dict(vars(outcome))

    def _read(self, seen: Observation) -> Readings:
        ranges = (seen.front_m, seen.left_m, seen.right_m)
        wheels = [count * self._rad_per_count for count in seen.encoder_increments]
        readings = {"line": seen.line, "ranges": ranges, "odometry": seen.odometry, "wheels": wheels, **seen.sensors}
        return {name: np.asarray(values, dtype=np.float32).reshape(-1) for name, values in readings.items()}

    def _observed_space(self) -> spaces.Dict:
        """Return the space of the observations; a short run shows how many numbers each sensor has."""
        with ClosedLoop(self._spec) as loop:
            readings = self._read(loop.observe(0))
        limits = {"line": (0.0, 1.0), "ranges": (0.0, _LARGEST_RANGE_M)}
        return spaces.Dict(
            {
                name: spaces.Box(*limits.get(name, (-np.inf, np.inf)), values.shape, np.float32)
                for name, values in readings.items()
            }
        )

    def _close_loop(self) -> None:
        if self._loop is not None:
            self._loop.close()
            self._loop = None


def _seeded(loaded: LoadedScenario, seed: int) -> LoadedScenario:
    """Return the scenario with another seed."""
    assert isinstance(loaded.root.value, dict)  # noqa: S101 - the schema demands it
    root = Node({**loaded.root.value, "seed": Node(seed, "the seed of reset")}, loaded.root.where)
    return replace(loaded, seed=seed, root=root)


def _action_space(robot: RobotConfig, kind: ActionKind) -> spaces.Box:
    """Return the limits of actions: what the motors can do without load."""
    limit_V = voltage_limit_V(robot.power)
    if kind == "voltages":
        return spaces.Box(-limit_V, limit_V, (2,), np.float32)
    fastest_m_s = 0.5 * robot.drive.wheel_diameter_m * MotorModel.from_config(robot.motor).steady_state(limit_V)[1]
    largest = np.array([fastest_m_s, 2.0 * fastest_m_s / robot.drive.track_m], dtype=np.float32)
    return spaces.Box(-largest, largest, dtype=np.float32)
