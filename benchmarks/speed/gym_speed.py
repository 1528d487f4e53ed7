"""Steps per second of the Gymnasium environment against control ticks per second of `symolo simulate`.

Both drive the same run with the same controller, in turns in one process on one core. Seconds are processor time, which
changes least while the machine is busy with something else. The ratio is the median over neighbouring pairs.

    python benchmarks/speed/gym_speed.py [--scenario symolo] [--seconds 20] [--repeats 5]
"""

import argparse
import os
import time
from statistics import median

import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.robot_controller import ControllerSettings
from physics.control.base import Observation
from physics.control.built_in import BuiltIn
from pipeline.gym.environment import DriveEnvironment
from pipeline.stages.simulate import simulate
from symolo.core.random_streams import stream


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    settings = ["stop.lap=false", f"stop.time_limit_s={arguments.seconds}"]
    steps, ticks, resets = [], [], []
    for _ in range(arguments.repeats):
        per_second, reset_s = steps_per_second(arguments.scenario, settings)
        steps.append(per_second)
        resets.append(reset_s)
        ticks.append(ticks_per_second(arguments.scenario, settings))
    ratio = median(step / tick for step, tick in zip(steps, ticks, strict=True))
    print(f"{arguments.scenario}, {arguments.seconds:g} s, medians of {arguments.repeats}")
    print(f"environment  {median(steps):7.1f} steps/s, reset {1e3 * median(resets):.0f} ms")
    print(f"simulate     {median(ticks):7.1f} ticks/s")
    print(f"ratio        {ratio:7.3f}")


def steps_per_second(scenario: str, settings: list[str]) -> tuple[float, float]:
    """Return the steps per second of one episode, and the time of its reset [s]."""
    environment = DriveEnvironment(scenario, settings)
    began = time.process_time()
    readings, _ = environment.reset(seed=1)
    reset_s = time.process_time() - began
    controller = BuiltIn(ControllerSettings(), environment.spec_of_run.robot, 20, stream(1))
    count, over, began = 0, False, time.process_time()
    while not over:
        front_m, left_m, right_m = readings["ranges"].tolist()
        x_m, y_m, yaw_rad = readings["odometry"].tolist()
        seen = Observation(tuple(readings["line"].tolist()), front_m, left_m, right_m, (x_m, y_m, yaw_rad))
        twist = controller.step(seen)
        action = np.array([twist.v_m_s, twist.w_rad_s], dtype=np.float32)
        readings, _, terminated, truncated, _ = environment.step(action)
        count, over = count + 1, terminated or truncated
    seconds = time.process_time() - began
    environment.close()
    return count / seconds, reset_s


def ticks_per_second(scenario: str, settings: list[str]) -> float:
    loaded = load_scenario(scenario, settings)
    spec = draw_run(loaded, loaded.routes[0].name, 1)
    began = time.process_time()
    outcome = simulate(spec)
    return len(outcome.recording.trajectory.t_s) / (time.process_time() - began)


if __name__ == "__main__":
    main()
