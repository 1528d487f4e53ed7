"""Two short drives and a motor bench that between them excite every effect, as bytes to compare."""

from collections.abc import Callable

import numpy as np
import pytest

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from physics.bullet.simulation import BulletSimulation
from physics.drivetrain.motor_bench import steady_states, step_responses
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin, ReplayedWorld
from sensors.fit_out import fit_out
from sensors.suite import SensorSuite
from sensors.wheels.instruments import read_current_A, read_speed_rad_s
from symolo.arena.geometry import Arena, Box, Line, Straight

TICK_STEPS, TICKS = 50, 12
PHYSICS_HZ = 1000
VOLTAGES = (2.8, 2.2)


@pytest.fixture(scope="session")
def excitable() -> RobotConfig:
    """The nominal robot, warm and in the light, with ranges that are not rounded."""
    settings = ("robot.tof.quantisation_m=0", "robot.tof.temperature_C=35", "robot.tof.ambient_lux=2000")
    return RobotConfig.model_validate(load_section("robot", "nominal", settings).tree)


@pytest.fixture(scope="session")
def walled() -> Arena:
    """A wall of white board across the way, which all three sensors see."""
    line = Line((Straight((-5.0, 0.0), (5.0, 0.0)),), 0.015, 0.05)
    wall = Box("wall", "wall", (0.75, 0.0, 0.1), (0.02, 4.0, 0.2), 0.0, "white_board")
    return Arena("walled", 4.0, 0.85, line, (wall,))


def _sensed(robot: RobotConfig, arena: Arena, world: BulletSimulation | ReplayedWorld) -> list[bytes]:
    sensors = fit_out(robot, arena, PHYSICS_HZ, lambda name: np.random.Generator(np.random.PCG64(len(name))))
    suite = SensorSuite(sensors, TICK_STEPS)
    found = []
    for tick in range(TICKS):
        readings = suite.read_at_tick(world, tick)
        found += [readings[name].tobytes() for name in ("tof", "line", "encoders")]
        pose = readings.get("pose_log", np.array(world.pose()))
        found.append(np.asarray(pose).tobytes())
    return found


@pytest.fixture(scope="session")
def read_in_engine(walled: Arena) -> Callable[[RobotConfig], list[bytes]]:
    def read(robot: RobotConfig) -> list[bytes]:
        with BulletSimulation(robot, walled, (0.0, 0.0, 0.0), Rates()) as world:
            world.set_voltages(*VOLTAGES)
            found = _sensed(robot, walled, world)
            t_s = np.arange(2) * 0.05
            speeds = np.array([(0.0, 0.0), world.wheel_speeds()])
            current = read_current_A(robot.effects, np.array(world.currents()))
            return [*found, current.tobytes(), read_speed_rad_s(robot.effects, t_s, speeds).tobytes()]

    return read


@pytest.fixture(scope="session")
def read_in_twin(walled: Arena) -> Callable[[RobotConfig], list[bytes]]:
    def read(robot: RobotConfig) -> list[bytes]:
        model = RobotModel.from_config(robot)
        run = KinematicTwin(model, 0.01).drive(np.tile(VOLTAGES, (60, 1, 1)), np.zeros((1, 3)))
        found = _sensed(robot, walled, ReplayedWorld(run, 0, walled, PHYSICS_HZ))
        return [*found, run.current_A.tobytes(), run.pose.tobytes()]

    return read


@pytest.fixture(scope="session")
def read_on_bench() -> Callable[[RobotConfig], list[bytes]]:
    def read(robot: RobotConfig) -> list[bytes]:
        model = RobotModel.from_config(robot)
        reversal = np.repeat([3.0, -3.0], 10)[:, None]
        current, speed = step_responses(model, reversal, 0.005)
        steady_current, steady_speed = steady_states(model, np.array([-2.0, 0.3, 4.0]), np.array([1.0, 2.0, 3.0]))
        t_s = 0.005 * np.arange(1, 21)
        found = [read_current_A(robot.effects, amperes) for amperes in (current, steady_current)]
        found += [read_speed_rad_s(robot.effects, t_s, speed), steady_speed]
        return [reading.tobytes() for reading in found]

    return read
