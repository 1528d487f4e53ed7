"""Short experiments that between them excite every slot: a drive in PyBullet, one in the twin, three benches, and a
floor.
"""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from typing import TypeVar

import numpy as np

from configs.effects.base import Slot
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.motor_bench import steady_states, step_responses
from physics.robot.floor_place import FloorPlace
from physics.robot.model import RobotModel, applied
from physics.twin import KinematicTwin, ReplayedWorld
from sensors.build import build_sensors
from sensors.ranging.range_effects import RangeEffects
from sensors.ranging.range_view import RangeView
from sensors.suite import SensorSuite, SteppedWorld
from sensors.wheels.instruments import read_current_A, read_settled_speed_rad_s, read_speed_rad_s
from symolo.arena.geometry import Arena, Box, Line, Straight
from symolo.core.arrays import Array

DRIVEN = (
    "drive: 0.6 s with 2.8 V and 2.2 V, less than before (in the twin then 1 V and 3 V), over a line, towards a wall "
    "at 0.75 m"
)
ON_MOTOR = (
    "motor bench: +3 V and then -3 V for 0.1 s each, steady states at -2 V, 0.3 V and 4 V, and those of a fast motor "
    "from 3 mV to 6 V within an hour"
)
AT_TARGETS = (
    "range bench: 24 targets at 0.05 to 1.95 m, up to 46 degrees oblique, at 14 to 44 degrees C, up to 7.5 klux, "
    "within an hour"
)
ON_FLOOR = "floor: places up to 10 m from the origin, yaws all around, within an hour"
ABOUT = (DRIVEN, ON_MOTOR, AT_TARGETS, ON_FLOOR)
"""The experiments in words, for a user whose effect changes none of their readings."""
PHYSICS_HZ, TICK_STEPS, TICKS = 1000, 50, 12
BEFORE_V, VOLTAGES_V, LATER_V = (3.0, 2.4), (2.8, 2.2), (1.0, 3.0)
"""Right and left; the first ones for no time and only in PyBullet, the later ones only in the twin."""
STEADY_V = (-2.0, 0.3, 4.0)
FAST = {"torque_constant_N_m_A": 0.06, "coulomb_friction_N_m": 1e-4, "viscous_friction_N_m_s_rad": 1e-7}
"""Motor of the second bench, which turns at up to 100 rad/s. A law may act at high speed only, or at low current."""
LADDER_V = np.append(np.geomspace(0.003, 0.3, 8), np.linspace(0.5, 6.0, 16))
FLOOR_M = np.linspace(-10.0, 10.0, 201)
HOUR_S = 3600.0
LADDER_S = HOUR_S * (0.618 * np.arange(1, len(LADDER_V) + 1) % 1.0)
"""Times of the steady states, in no order, so that a law of time is none of speed."""

Readings = Mapping[str, Array]
"""Readings by channel."""

Value = TypeVar("Value")


def equal(some: Readings, others: Readings) -> bool:
    """Return whether all bits of two sets of readings are equal."""
    return some.keys() == others.keys() and all(some[name].tobytes() == others[name].tobytes() for name in some)


@contextmanager
def without_messages_of_engines() -> Iterator[None]:
    """Leave out what an engine writes to file descriptor 2 while it is loaded, such as the time of its build."""
    sys.stderr.flush()
    before, (unread, pipe) = os.dup(2), os.pipe()
    os.dup2(pipe, 2)
    try:
        yield
    finally:
        os.dup2(before, 2)
        for descriptor in (before, unread, pipe):
            os.close(descriptor)


class Probe:
    """The experiments, each as a function of a robot."""

    @cached_property
    def robot(self) -> RobotConfig:
        """The nominal robot, warm and in the light, with ranges that are not rounded."""
        settings = ("robot.tof.quantisation_m=0", "robot.tof.temperature_C=35", "robot.tof.ambient_lux=2000")
        return RobotConfig.model_validate(load_section("robot", "nominal", settings).tree)

    @cached_property
    def arena(self) -> Arena:
        """A wall of white board across the way, which all three sensors see, and a line that every channel crosses."""
        line = Line((Straight((-2.88, -3.0), (3.12, 3.0)),), 0.015, 0.05)
        wall = Box("wall", "wall", (0.75, 0.0, 0.1), (0.02, 4.0, 0.2), 0.0, "white_board")
        return Arena("walled", 4.0, 0.85, line, (wall,))

    def bare(self, place: str) -> Readings:
        """Return the readings of the robot without effects in one of the experiments, by the name of its method."""
        if place not in self._bare:
            self._bare[place] = getattr(self, place)(self.robot)
        return self._bare[place]

    @cached_property
    def _bare(self) -> dict[str, Readings]:
        return {}

    def in_engine(self, robot: RobotConfig) -> Readings:
        """Return the readings of a drive in PyBullet."""
        with without_messages_of_engines():
            from physics.bullet.simulation import BulletSimulation  # noqa: PLC0415 - loads PyBullet

        with BulletSimulation(robot, self.arena, (0.0, 0.0, 0.0), Rates()) as world:
            world.set_voltages(*BEFORE_V)
            world.set_voltages(*VOLTAGES_V)
            sensed = self._sensed(robot, world)
            speeds = np.array([(0.0, 0.0), world.wheel_speeds()])
            current = read_current_A(robot.effects, np.array(world.currents()), np.array(world.time_s))
            speed = read_speed_rad_s(robot.effects, np.arange(2) * 0.05, speeds)
            return {**sensed, "current_A": current, "speed_rad_s": speed}

    def in_twin(self, robot: RobotConfig) -> Readings:
        """Return the readings of a drive without an engine that turns the other way in its second half."""
        model = RobotModel.from_config(robot)
        voltages = np.repeat([VOLTAGES_V, LATER_V], 30, axis=0)[:, None]
        rng = np.random.Generator(np.random.PCG64(0))
        run = KinematicTwin(model, 0.01, rng).drive(voltages, np.zeros((1, 3)))
        sensed = self._sensed(robot, ReplayedWorld(run, 0, self.arena, PHYSICS_HZ))
        return {**sensed, "current_A": run.current_A, "true_pose": run.pose}

    def path(self, robot: RobotConfig, parts: int) -> Array:
        """Return the poses (T, 1, 3) every 10 ms of the drive without an engine, in steps of a part of 10 ms each."""
        voltages = np.repeat([VOLTAGES_V, LATER_V], 30 * parts, axis=0)[:, None]
        run = KinematicTwin(RobotModel.from_config(robot), 0.01 / parts).drive(voltages, np.zeros((1, 3)))
        return run.pose[::parts]

    def on_bench(self, robot: RobotConfig) -> Readings:
        """Return the readings of a motor, and of a range sensor before targets."""
        model = RobotModel.from_config(robot)
        reversal = np.repeat([3.0, -3.0], 20)[:, None]
        current, speed = step_responses(model, reversal, 0.005)
        first_s = np.array([1.0, 2.0, 3.0])
        steady_current, steady_speed = steady_states(model, np.array(STEADY_V), first_s)
        steady_s = np.append(first_s, LADDER_S)
        t_s = 0.005 * np.arange(1, 41)
        fast = RobotModel.from_config(robot.with_section("motor", FAST))
        fast_current, fast_speed = steady_states(fast, LADDER_V, LADDER_S)
        mean_m, sd_m = _before_targets(robot)
        return {
            "step_current_A": read_current_A(robot.effects, current, t_s[:, None]),
            "step_speed_rad_s": read_speed_rad_s(robot.effects, t_s, speed),
            "steady_current_A": read_current_A(robot.effects, np.append(steady_current, fast_current), steady_s),
            "steady_speed_rad_s": np.append(
                steady_speed, read_settled_speed_rad_s(robot.effects, fast_speed, LADDER_S)
            ),
            "range_m": mean_m,
            "range_sd_m": sd_m,
        }

    def on_floor(self, robot: RobotConfig) -> Readings:
        """Return what depends on places: those of a grid, each at another time, and yaws all around."""
        model = RobotModel.from_config(robot)
        x_m, y_m = (each.reshape(-1, 1) for each in np.meshgrid(FLOOR_M, FLOOR_M))
        time_s = HOUR_S * (0.618 * np.arange(1, len(x_m) + 1)[:, None] % 1.0)
        wheels, place = np.ones((len(x_m), 2)), FloorPlace(x_m, y_m, time_s)
        friction_N_m = Driveline.of_robot(model).friction_N_m(wheels, wheels, time_s, 1.0, (x_m, y_m))
        yaw_rad = np.linspace(-np.pi, np.pi, len(x_m))
        return {
            "friction_N_m": np.broadcast_to(friction_N_m, wheels.shape).copy(),
            "travel": applied(model.functions(Slot.TRAVEL), wheels, place),
            "turning": applied(model.functions(Slot.TURNING), np.ones_like(x_m), place),
            "heading_error_rad": applied(
                model.functions(Slot.POSE_HEADING), np.zeros_like(yaw_rad), yaw_rad, time_s[:, 0]
            ),
            # Straight ahead and on the spot.
            "creep_m": applied(model.functions(Slot.CREEP), np.zeros((2, 2)), np.ones((2, 1)), np.eye(2)[:, :1]),
        }

    def _sensed(self, robot: RobotConfig, world: SteppedWorld) -> dict[str, Array]:
        sensors = build_sensors(
            robot, self.arena, PHYSICS_HZ, lambda name: np.random.Generator(np.random.PCG64(len(name)))
        )
        suite = SensorSuite(sensors, TICK_STEPS)
        rows_by_sensor: dict[str, list[Array]] = {"tof": [], "line": [], "encoders": [], "pose": []}
        for tick in range(TICKS):
            readings = suite.read_at_tick(world, tick)
            for name in ("tof", "line", "encoders"):
                rows_by_sensor[name].append(np.asarray(readings[name], dtype=float))
            rows_by_sensor["pose"].append(np.asarray(readings.get("pose_log", np.array(world.pose())), dtype=float))
        return {name: np.stack(rows) for name, rows in rows_by_sensor.items()}


def _before_targets(robot: RobotConfig) -> tuple[Array, Array]:
    """Return readings (24,) without noise, and its standard deviation, before targets in several directions."""
    distance_m = np.linspace(0.05, 1.95, 24)
    row = np.arange(24)
    materials = ("white_board", "black_board", "wood", "paper")
    view = RangeView(
        distance_m=distance_m,
        previous_distance_m=np.append(distance_m[0], distance_m[:-1]),
        incidence_rad=0.2 * (row % 5),
        tilt_forward_rad=0.2 * (row % 5) * np.where(row % 2, 1.0, -1.0),
        tilt_sideways_rad=0.1 * (row % 3 - 1.0),
        reflectance=np.array([0.85, 0.05, 0.5, 0.7])[row % 4],
        material_share={name: (row % 4 == k).astype(float) for k, name in enumerate(materials)},
        temperature_C=14.0 + 5.0 * (row % 7),
        reference_temperature_C=robot.tof.reference_temperature_C,
        ambient_lux=1500.0 * (row % 6),
        time_s=HOUR_S / 24.0 * row,
        normal_rad=0.5 * np.pi * (row % 4),
    )
    effects = RangeEffects.from_effects(robot.effects.without("tof_range_offset"))
    reading_m, sd_m = effects.seen(distance_m, 0.002 + 0.001 * (row % 3), view)
    return effects.limited(reading_m), sd_m
