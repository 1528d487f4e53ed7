"""The closed loop: at the control rate PyBullet moves the robot, the sensors read and the controller commands."""

import math
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from configs.schema.scenario import RunSpec
from physics.bullet.simulation import BulletSimulation
from physics.control.base import ControlInput
from physics.run.lap import Lap
from physics.run.pilot import BuiltInPilot, Decision, Pilot
from sensors.base import Reading
from sensors.fit_out import fit_out
from sensors.instruments import read_current_A, read_speed_rad_s
from sensors.odometry import Odometry
from sensors.suite import SensorSuite
from symolo.arena.geometry import Arena
from symolo.core.errors import RunFailed
from symolo.core.random_streams import stream
from symolo.core.time_series import Recording, TimeSeries, Trajectory
from symolo.dataset.codes import State
from symolo.dataset.tables.obstacles import obstacle_series
from symolo.dataset.tables.side_tables import BOARD_SERIES

Progress = Callable[[float, float], None]
"""Called with the simulated time and the time limit [s]."""
Watch = Callable[[float, ControlInput, Decision], None]
"""Called at each control tick with the simulated time [s], the readings for the pilot and its decision."""


@dataclass(frozen=True)
class Outcome:
    """The result of a run; `problems` is empty if it may be released."""

    recording: Recording
    finished: bool
    problems: tuple[str, ...]
    lap_time_s: float | None


def simulate(
    spec: RunSpec, progress: Progress | None = None, pilot: Pilot | None = None, watch: Watch | None = None
) -> Outcome:
    """Drive one run to its end: a closed lap, the time limit, a collision, or a failure of the pilot.

    Args:
        spec: Run specification.
        progress: Called with the time that has passed.
        pilot: The pilot that drives; by default the built-in controller.
        watch: Called at every control tick.
    """
    arena = Arena.from_config(spec.arena)
    start = (spec.start.x_m, spec.start.y_m, math.radians(spec.start.yaw_deg))
    with BulletSimulation(spec.robot, arena, start, spec.rates) as world:
        return _ClosedLoop(spec, arena, start, world, pilot or BuiltInPilot(spec.robot), watch).drive(progress)


class _ClosedLoop:
    def __init__(  # noqa: PLR0917 - everything that a run needs
        self,
        spec: RunSpec,
        arena: Arena,
        start: tuple[float, float, float],
        world: BulletSimulation,
        pilot: Pilot,
        watch: Watch | None,
    ) -> None:
        self._spec = spec
        self._pilot = pilot
        self._watch = watch
        self._world = world
        self._arena = arena
        robot, rates = spec.robot, spec.rates
        self._tick_steps = rates.physics_hz // rates.control_hz
        self._ticks_per_image = rates.control_hz // rates.camera_hz
        sensors = fit_out(
            robot, arena, rates.physics_hz, lambda name: stream(spec.seed, spec.route, spec.run, "sensors", name)
        )
        self._suite = SensorSuite(sensors, self._tick_steps)
        self._odometry = Odometry.from_config(robot)
        self._believed = (0.0, 0.0, 0.0)
        self._counts = np.zeros(2, dtype=np.int64)
        self._lap = Lap(start)
        self._units: dict[str, str] = {}
        self._values: dict[str, list[object]] = defaultdict(list)
        """Recorded values by name of the series, one for each control tick; they are stacked at the end."""

    def drive(self, progress: Progress | None) -> Outcome:
        spec = self._spec
        limit_ticks = math.ceil(spec.stop.time_limit_s * spec.rates.control_hz)
        problems: list[str] = []
        lap_time_s = None
        for tick in range(limit_ticks + 1):
            time_s = tick / spec.rates.control_hz
            try:
                self._tick(tick)
            except RunFailed as error:
                problems.append(str(error))
                break
            if touched := self._world.touching():
                problems.append(f"touched {', '.join(touched)} at {time_s:.2f} s")
                break
            if self._lap.closed and lap_time_s is None:
                lap_time_s = time_s
                if spec.stop.lap:
                    break
            if progress is not None and tick % spec.rates.control_hz == 0:
                progress(time_s, spec.stop.time_limit_s)
        if spec.stop.lap and lap_time_s is None and not problems:
            x, y, _ = self._world.pose()
            problems.append(
                f"lap not finished within {spec.stop.time_limit_s:g} s, last at x = {x:.2f}, y = {y:.2f} m"
                f" in state {self._values['state'][-1]}"
            )
        return Outcome(self._recording(), not problems, tuple(problems), lap_time_s)

    def _tick(self, tick: int) -> None:
        readings = self._suite.read_at_tick(self._world, tick)
        counts = np.asarray(readings["encoders"], dtype=np.int64)
        turned = counts - self._counts
        self._believed = self._odometry.step(self._believed, turned)
        self._counts = counts
        front_m, left_m, right_m = (float(range_m) for range_m in readings["tof"][:, 0])
        line = tuple(float(reflectance) for reflectance in readings["line"])
        control_input = ControlInput(line, front_m, left_m, right_m, self._believed)
        decision = self._pilot.decide(control_input, (int(turned[0]), int(turned[1])))
        if self._watch is not None:
            self._watch(tick / self._spec.rates.control_hz, control_input, decision)
        self._world.set_wheel_speeds(*decision.wheels_rad_s)
        self._lap.update(self._world.pose(), on_track=decision.command.state is State.LINE)
        self._record(tick, readings, decision)

    def _record(self, tick: int, readings: dict[str, Reading], decision: Decision) -> None:
        world, command = self._world, decision.command
        image = 1 + tick // self._ticks_per_image if tick % self._ticks_per_image == 0 else 0
        row: list[tuple[str, str, object]] = [
            ("pose", "m, m, rad", world.pose()),
            ("twist", "m/s, rad/s", world.twist()),
            ("state", "1", int(command.state)),
            *((series.name, series.unit, values) for series, values in self._suite.recorded(readings)),
            ("odometry", "m, m, rad", self._believed),
            ("wheel_speed_rad_s", "rad/s", world.wheel_speeds()),
            ("voltage_V", "V", world.voltages()),
            ("mean_voltage_V", "V", world.take_mean_voltages()),
            ("current_A", "A", world.currents()),
            ("command", "m/s, rad/s", (command.v_m_s, command.w_rad_s)),
            ("line_lost", "1", decision.line_lost),
            *([(BOARD_SERIES, "1", decision.board)] if decision.board else []),
            ("image", "1", image),
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
        stacked["current_A"] = read_current_A(effects, stacked["current_A"])
        in_trajectory = {"pose", "twist", "state"}
        series = [
            TimeSeries(name, self._units[name], t_s, values)
            for name, values in stacked.items()
            if name not in in_trajectory
        ]
        return Recording(trajectory, (*series, *obstacle_series(self._arena, t_s)))
