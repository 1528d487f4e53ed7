"""One robot in its arena with its sensors, from one control tick to the next."""

import math

import numpy as np
from typing_extensions import Self

from configs.schema.scenario import RunSpec
from physics.bullet.simulation import BulletSimulation
from physics.control.base import Observation
from physics.run.controller_runner import Decision
from physics.run.lap import LapDetector
from sensors.base import Reading
from sensors.build import build_sensors
from sensors.suite import SensorSuite
from sensors.wheels.odometry import Odometry
from symolo.arena.geometry import Arena
from symolo.core.geometry.poses import PlanarPose
from symolo.core.random_streams import stream
from symolo.dataset.codes import State


class ClosedLoop:
    """The robot and its sensors from one control tick to the next: `observe` and `act` in turn.

    Close it, or use it as a context manager.
    """

    def __init__(self, spec: RunSpec) -> None:
        self.arena = Arena.from_config(spec.arena)
        start = (spec.start.x_m, spec.start.y_m, math.radians(spec.start.yaw_deg))
        rng = stream(spec.seed, spec.route, spec.run, "wheels")
        self.world = BulletSimulation(spec.robot, self.arena, start, spec.rates, rng)
        try:
            self._build_sensors(spec, start)
        except BaseException:
            self.world.close()
            raise

    def _build_sensors(self, spec: RunSpec, start: PlanarPose) -> None:
        robot, rates = spec.robot, spec.rates
        self._control_hz = rates.control_hz
        tick_steps = rates.physics_hz // rates.control_hz
        sensors = build_sensors(
            robot, self.arena, rates.physics_hz, lambda name: stream(spec.seed, spec.route, spec.run, "sensors", name)
        )
        self.suite = SensorSuite(sensors, tick_steps)
        self._further = tuple(name for name in robot.sensors.names if name in sensors)
        self._odometry = Odometry.from_config(robot)
        self._believed = (0.0, 0.0, 0.0)
        self._counts = np.zeros(2, dtype=np.int64)
        self.lap = LapDetector(start)
        self.readings: dict[str, Reading] = {}
        """Readings of all sensors at the last tick."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def close(self) -> None:
        self.world.close()

    def observe(self, tick: int) -> Observation:
        """Advance the world to a tick and return what the controller observes; ticks are in order, from 0."""
        readings = self.readings = self.suite.read_at_tick(self.world, tick)
        counts = np.asarray(readings["encoders"], dtype=np.int64)
        turned = counts - self._counts
        self._believed = self._odometry.step(self._believed, turned)
        self._counts = counts
        front_m, left_m, right_m = (float(range_m) for range_m in readings["tof"][:, 0])
        return Observation(
            line=tuple(float(reflectance) for reflectance in readings["line"]),
            front_m=front_m,
            left_m=left_m,
            right_m=right_m,
            odometry=self._believed,
            t_s=tick / self._control_hz,
            encoder_counts=(int(counts[0]), int(counts[1])),
            encoder_increments=(int(turned[0]), int(turned[1])),
            sensors={name: readings[name] for name in self._further},
        )

    def act(self, decision: Decision) -> None:
        """Set what the wheels do until the next tick."""
        if decision.voltages_V is None:
            self.world.set_wheel_speeds(*decision.wheels_rad_s)
        else:
            self.world.set_voltages(*decision.voltages_V)
        self.lap.update(self.world.pose(), on_track=decision.command.state is State.LINE)
