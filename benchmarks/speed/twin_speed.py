"""Wall time of the engine-free twin against PyBullet for the same open-loop voltages, and how far apart they end.

Both are timed in turns in one process on one core, without sensors; medians are compared. The twin's time is that of a
batch over its trials, since a fit drives all trials of a log at once. Few trials of bare motors are stepped in plain
numbers; with effects that look at the speed (robot `worn`) every step is one of arrays, and a trial alone gains little.

    python benchmarks/speed/twin_speed.py [--robot nominal] [--repeats 3]
"""

import argparse
import os
import time
from itertools import pairwise
from statistics import median

import numpy as np
from step_size import PROFILE, ROWS_HZ, drive

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin, TwinRun

ENGINE_HZ = 1000
STEPS_S = (0.001, 0.005, 0.01)
TRIALS = (1, 10, 100)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="nominal")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    robot = RobotConfig.model_validate(load_section("robot", arguments.robot).tree)
    cases = [(step_s, trials) for step_s in STEPS_S for trials in TRIALS]
    engine_s: list[float] = []
    twin_s: dict[tuple[float, int], list[float]] = {case: [] for case in cases}
    apart: dict[tuple[float, int], str] = {}
    for _ in range(arguments.repeats):
        poses, seconds = drive(robot, PROFILE, ENGINE_HZ)
        engine_s.append(seconds)
        for step_s, trials in cases:
            run, seconds = time_twin(robot, step_s, trials)
            twin_s[step_s, trials].append(seconds)
            apart[step_s, trials] = described(run.pose[:: round(1 / ROWS_HZ / step_s), 0] - poses)
    simulated_s, per_trial_s = PROFILE.rows[-1][0], median(engine_s)
    print(f"{arguments.robot}: {simulated_s:g} s, medians of {arguments.repeats}")
    print(f"PyBullet at 1 ms: {per_trial_s:.3f} s, {simulated_s / per_trial_s:.0f} x real time")
    print("twin: step [ms]  trials  per trial [ms]  x real time  x PyBullet  largest distance from PyBullet")
    for (step_s, trials), seconds in twin_s.items():
        each = median(seconds) / trials
        print(
            f"{1e3 * step_s:15g} {trials:7d} {1e3 * each:15.2f} {simulated_s / each:12.0f} {per_trial_s / each:11.1f}"
            f"  {apart[step_s, trials]}"
        )


def time_twin(robot: RobotConfig, step_s: float, trials: int) -> tuple[TwinRun, float]:
    """Return the run and its wall time [s]."""
    rows = [[pair] * round((end - begin) / step_s) for (begin, *pair), (end, *_) in pairwise(PROFILE.rows)]
    voltages = np.array([pair for part in rows for pair in part])[:, None]
    model = RobotModel.from_config(robot)
    begin = time.perf_counter()
    run = KinematicTwin(model, step_s).drive(np.repeat(voltages, trials, axis=1), np.zeros((trials, 3)))
    return run, time.perf_counter() - begin


def described(apart: np.ndarray) -> str:
    far_mm = 1e3 * np.hypot(apart[:, 0], apart[:, 1]).max()
    return f"{far_mm:.2f} mm, {np.degrees(np.abs(apart[:, 2])).max():.3f} degrees"


if __name__ == "__main__":
    main()
