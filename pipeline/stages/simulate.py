"""The closed loop: at the control rate PyBullet moves the robot, the sensors read and the controller commands."""

import math
from collections import defaultdict
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from physics.control.base import Observation
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.robot.model import RobotModel
from physics.run.controller_runner import ControllerRunner, Decision, InProcessRunner
from pipeline.stages.closed_loop import ClosedLoop
from sensors.wheels.instruments import read_current_A, read_speed_rad_s
from symolo.core.errors import InputError, RunFailed
from symolo.core.random_streams import stream
from symolo.core.tables.time_series import Recording, TimeSeries, Trajectory
from symolo.dataset.tables.camera_rows import image_column
from symolo.dataset.tables.obstacles import obstacle_series
from symolo.dataset.tables.side_tables import BOARD_SERIES

Progress = Callable[[float, float], None]
"""Called with the simulated time and the time limit [s]."""
Watch = Callable[[float, Observation, Decision], None]
"""Called at each control tick with the simulated time [s], the readings for the controller and its decision."""


MAX_OF_NO_LOAD = 3.0
"""Largest speed of a wheel relative to that of its motor without load. A slope, a push or an effect on the motor adds
less; an unstable simulation soon adds more."""


@dataclass(frozen=True)
class DriveOutcome:
    """The result of a run; `problems` is empty if it may be released."""

    recording: Recording
    finished: bool
    problems: tuple[str, ...]
    lap_time_s: float | None


def simulate(
    spec: RunSpec, progress: Progress | None = None, runner: ControllerRunner | None = None, watch: Watch | None = None
) -> DriveOutcome:
    """Drive one run to its end: a closed lap, the time limit, a collision, or a failure of the controller.

    Args:
        spec: Run specification.
        progress: Called with the time that has passed.
        runner: Runs the controller; by default it is that of the specification, in this process.
        watch: Called at every control tick.

    Raises:
        InputError: The class of the controller, or its program, is not there.
        RunFailed: The controller cannot start.
    """
    with ClosedLoop(spec) as loop:
        if runner is not None:
            return _Recorder(spec, loop, runner, watch).drive(progress)
        rng = stream(spec.seed, spec.route, spec.run, "controller")
        with closing(InProcessRunner.from_robot(spec.robot, spec.rates.control_hz, rng, spec.controller)) as built_in:
            return _Recorder(spec, loop, built_in, watch).drive(progress)


def _runaway(robot: RobotConfig, speeds_rad_s: tuple[float, float], time_s: float) -> str:
    """Return what is wrong with the speeds of the wheels, right and left; empty where a motor can reach them."""
    motors = RobotModel.from_config(robot).motors
    no_load_rad_s = voltage_limit_V(robot.power) / min(
        motors.right.torque_constant_N_m_A, motors.left.torque_constant_N_m_A
    )
    if all(abs(speed) <= MAX_OF_NO_LOAD * no_load_rad_s for speed in speeds_rad_s):
        return ""
    fastest = max(speeds_rad_s, key=abs)
    return (
        f"a wheel turns at {fastest:.4g} rad/s at {time_s:.2f} s, and its motor reaches {no_load_rad_s:.3g} rad/s"
        " without load: the simulation is unstable; raise rates.physics_hz, or check the motor and its effects"
    )


class _Recorder:
    """A run from its first tick to its end, with everything that is recorded of it."""

    def __init__(self, spec: RunSpec, loop: ClosedLoop, runner: ControllerRunner, watch: Watch | None) -> None:
        self._spec, self._loop, self._runner, self._watch = spec, loop, runner, watch
        self._units: dict[str, str] = {}
        self._values: dict[str, list[object]] = defaultdict(list)
        """Recorded values by name of the series, one for each control tick; they are stacked at the end."""

    def drive(self, progress: Progress | None) -> DriveOutcome:
        spec = self._spec
        limit_ticks = math.ceil(spec.stop.time_limit_s * spec.rates.control_hz)
        problems: list[str] = []
        lap_time_s = None
        for tick in range(limit_ticks + 1):
            time_s = tick / spec.rates.control_hz
            try:
                self._tick(tick)
            except RunFailed as error:
                if tick == 0:  # there is nothing to record
                    raise
                problems.append(str(error))
                break
            if runaway := _runaway(spec.robot, self._loop.world.wheel_speeds(), time_s):
                problems.append(runaway)
                break
            if touched := self._loop.world.touching():
                problems.append(f"touched {', '.join(touched)} at {time_s:.2f} s")
                break
            if self._loop.lap.closed and lap_time_s is None:
                lap_time_s = time_s
                if spec.stop.lap:
                    break
            if progress is not None and tick % spec.rates.control_hz == 0:
                progress(time_s, spec.stop.time_limit_s)
        if spec.stop.lap and lap_time_s is None and not problems:
            x, y, _ = self._loop.world.pose()
            problems.append(
                f"lap not finished within {spec.stop.time_limit_s:g} s, last at x = {x:.2f}, y = {y:.2f} m"
                f" in state {self._values['state'][-1]}; to end all runs at stop.time_limit_s, set stop.lap=false"
            )
        return DriveOutcome(self._recording(), not problems, tuple(problems), lap_time_s)

    def _tick(self, tick: int) -> None:
        try:
            seen = self._loop.observe(tick)
        except InputError as error:  # a reading of a sensor of the user's own
            raise InputError(f"{self._spec.key}: {error}") from error
        decision = self._runner.decide(seen)
        if self._watch is not None:
            self._watch(seen.t_s, seen, decision)
        self._loop.act(decision)
        self._record(seen, decision)

    def _record(self, seen: Observation, decision: Decision) -> None:
        loop, world, command = self._loop, self._loop.world, decision.command
        row: list[tuple[str, str, object]] = [
            ("pose", "m, m, rad", world.pose()),
            ("twist", "m/s, rad/s", world.twist()),
            ("state", "1", int(command.state)),
            *((series.name, series.unit, values) for series, values in loop.suite.recorded(loop.readings)),
            ("odometry", "m, m, rad", seen.odometry),
            ("wheel_speed_rad_s", "rad/s", world.wheel_speeds()),
            ("voltage_V", "V", world.voltages()),
            ("mean_voltage_V", "V", world.take_mean_voltages()),
            ("current_A", "A", world.currents()),
            ("command", "m/s, rad/s", (command.v_m_s, command.w_rad_s)),
            ("line_lost", "1", decision.line_lost),
            *([(BOARD_SERIES, "1", decision.board)] if decision.board else []),
        ]
        for name, unit, value in row:
            self._units[name] = unit
            self._values[name].append(value)

    def _recording(self) -> Recording:
        effects = self._spec.robot.effects
        stacked = {name: np.array(values) for name, values in self._values.items()}
        t_s = np.arange(len(stacked["state"])) / self._spec.rates.control_hz
        trajectory = Trajectory(t_s, stacked["pose"], stacked["twist"], stacked["state"])
        stacked["wheel_speed_rad_s"] = read_speed_rad_s(effects, t_s, stacked["wheel_speed_rad_s"])
        stacked["current_A"] = read_current_A(effects, stacked["current_A"], t_s[:, None])
        stacked["image"] = image_column(np.rint(1000 * t_s).astype(np.int64), self._spec.rates)
        self._units["image"] = "1"
        in_trajectory = {"pose", "twist", "state"}
        series = [
            TimeSeries(name, self._units[name], t_s, values)
            for name, values in stacked.items()
            if name not in in_trajectory
        ]
        samples = self._loop.suite.samples(self._spec.rates.physics_hz)
        return Recording(trajectory, (*series, *obstacle_series(self._loop.arena, t_s), *samples))
