"""Processor time of a whole lap with all sensors and the controller against bare `stepSimulation` on the same world.

Both run in turns in one process on one core, for the same number of steps. Processor time, and the median ratio of
neighbouring pairs, change least while the machine is busy with something else. The cost of each sensor is taken in
separate laps, because the clocks cost time too. With `--set`, laps with and without these settings are timed in turns
as well.

    python benchmarks/speed/simulation_speed.py [--scenario symolo] [--route CW] [--repeats 7]
    python benchmarks/speed/simulation_speed.py --set "robot.sensors={lidar: {}, imu: {}}"
"""

import argparse
import os
import time
from collections.abc import Callable
from math import copysign, radians
from statistics import median
from typing import TypeVar
from unittest.mock import patch

import numpy as np
import pybullet

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from physics.bullet.body import add_robot
from physics.bullet.world import add_arena, connect
from physics.drivetrain.motor import MotorModel
from pipeline.stages import closed_loop
from pipeline.stages.simulate import simulate
from sensors.base import Sensor, World
from sensors.build import build_sensors
from symolo.arena.geometry import Arena

WHEEL_SPEED_RAD_S = 4.0
Result = TypeVar("Result")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--route", default="CW")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="PATH=VALUE")
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    plain = draw_run(load_scenario(arguments.scenario), arguments.route, 1)
    spec = draw_run(load_scenario(arguments.scenario, arguments.settings), arguments.route, 1)
    laps, plain_laps, bares, steps = [], [], [], 0
    shares: dict[str, list[float]] = {}
    for _ in range(arguments.repeats):
        seconds, steps = time_lap(spec)
        laps.append(seconds)
        bares.append(time_bare(spec, steps))
        if arguments.settings:
            plain_laps.append(time_lap(plain)[0])
        for name, share in time_sensors(spec).items():
            shares.setdefault(name, []).append(share)
    simulated_s = steps / spec.rates.physics_hz
    print(
        f"{arguments.scenario} {arguments.route}: {simulated_s:.2f} s in {steps} steps, medians of {arguments.repeats}"
    )
    for name, seconds in (("whole lap, all sensors", median(laps)), ("bare stepSimulation", median(bares))):
        per_step_us, times_real = 1e6 * seconds / steps, simulated_s / seconds
        print(f"{name:24s} {seconds:7.3f} s {per_step_us:7.1f} us/step {times_real:7.1f} x real time")
    print(f"{60.0 / median(laps):.1f} laps and {60e-6 * steps / median(laps):.2f} million steps a minute on one core")
    print_ratio("the bare engine", laps, bares)
    if arguments.settings:
        print_ratio("a lap without --set", laps, plain_laps)
    for name, share in shares.items():
        print(f"{name:24s} {100.0 * median(share):5.1f} % of a lap")


def print_ratio(name: str, laps_s: list[float], others_s: list[float]) -> None:
    ratios = [lap_s / other_s for lap_s, other_s in zip(laps_s, others_s, strict=True)]
    print(f"{median(ratios):.2f} times {name}, of neighbouring pairs {min(ratios):.2f} to {max(ratios):.2f}")


def time_lap(spec: RunSpec) -> tuple[float, int]:
    """Processor time [s] of one run, and its physics steps."""
    begin = time.process_time()
    outcome = simulate(spec)
    elapsed = time.process_time() - begin
    if outcome.problems:
        raise SystemExit(f"the run failed: {'; '.join(outcome.problems)}")
    return elapsed, round(float(outcome.recording.trajectory.t_s[-1]) * spec.rates.physics_hz)


def time_sensors(spec: RunSpec) -> dict[str, float]:
    """Share of a lap's time that each sensor takes, by name."""
    spent: dict[str, float] = {}

    def timed(name: str, method: Callable[[World], Result]) -> Callable[[World], Result]:
        def method_timed(world: World) -> Result:
            begin = time.process_time()
            result = method(world)
            spent[name] = spent.get(name, 0.0) + time.process_time() - begin
            return result

        return method_timed

    def build_sensors_timed(
        robot: RobotConfig, arena: Arena, physics_hz: int, rng_of: Callable[[str], np.random.Generator]
    ) -> dict[str, Sensor]:
        sensors = build_sensors(robot, arena, physics_hz, rng_of)
        for name, sensor in sensors.items():
            sensor.sample = timed(name, sensor.sample)  # type: ignore[method-assign]
            sensor.subsample = timed(name, sensor.subsample)  # type: ignore[method-assign]
        return sensors

    with patch.object(closed_loop, "build_sensors", build_sensors_timed):
        seconds, _ = time_lap(spec)
    return {name: taken_s / seconds for name, taken_s in spent.items()}


def time_bare(spec: RunSpec, steps: int) -> float:
    """Processor time [s] of the engine's steps alone, while the robot turns on the spot.

    Joint motors out of reach of their target are constant torques, so that the solver has the work it has in a lap.
    """
    client = connect(spec.rates.physics_hz)
    add_arena(client, Arena.from_config(spec.arena))
    start = (spec.start.x_m, spec.start.y_m, radians(spec.start.yaw_deg))
    robot, wheels = add_robot(client, spec.robot, start, 1.0 / spec.rates.physics_hz)
    torque = MotorModel.from_config(spec.robot.motor).damping_N_m_s_rad * WHEEL_SPEED_RAD_S
    for wheel, sign in zip(wheels, (1.0, -1.0), strict=True):
        pybullet.setJointMotorControl2(
            robot,
            wheel,
            pybullet.VELOCITY_CONTROL,
            targetVelocity=copysign(100.0 * WHEEL_SPEED_RAD_S, sign),
            force=torque,
            physicsClientId=client,
        )
    step = pybullet.stepSimulation
    begin = time.process_time()
    for _ in range(steps):
        step(physicsClientId=client)
    elapsed = time.process_time() - begin
    pybullet.disconnect(client)
    return elapsed


if __name__ == "__main__":
    main()
