"""Pose error against the physics step for the same open-loop voltages: 10 s of starts, arcs, a turn on the spot, stops.

The reference is the smallest step. Every pose at the control rate is compared, so that no error hides in a lucky end.

    python benchmarks/step_size.py
"""

import time
from itertools import pairwise

import numpy as np

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from physics.arena import Arena, Line
from physics.bullet.simulation import BulletSimulation

PROFILE = ((0.0, 2.0, 2.0), (1.0, 2.4, 1.4), (3.0, 1.2, 2.2), (4.5, 2.0, 2.0), (5.5, -1.5, 1.5), (6.5, 0.0, 0.0))
PROFILE += ((7.0, 1.6, 1.6), (8.0, 1.0, 2.6), (9.0, -1.2, -1.2), (9.6, 0.0, 0.0), (10.0, 0.0, 0.0))
"""From when [s], right and left voltage."""
ROWS_HZ = 20
REFERENCE_HZ = 8000
RATES_HZ = (4000, 2000, 1000, 500)


def main() -> None:
    robot = RobotConfig.model_validate(load_section("robot", "nominal").tree)
    reference, _ = drive(robot, REFERENCE_HZ)
    length_m = np.hypot(*np.diff(reference[:, :2], axis=0).T).sum()
    turned_rad = np.abs(np.diff(reference[:, 2])).sum()
    print(f"{PROFILE[-1][0]:g} s, {length_m:.2f} m, {turned_rad:.1f} rad turned; reference {1e3 / REFERENCE_HZ:g} ms")
    print("step [ms]   position [mm]: end   worst   yaw [mrad]: end   worst   wall time / real time")
    for rate_hz in RATES_HZ:
        poses, seconds = drive(robot, rate_hz)
        position_mm = 1e3 * np.hypot(*(poses - reference)[:, :2].T)
        yaw_mrad = 1e3 * np.abs((poses - reference)[:, 2])
        print(
            f"{1e3 / rate_hz:9.3g} {position_mm[-1]:20.3f} {position_mm.max():7.3f}"
            f" {yaw_mrad[-1]:17.3f} {yaw_mrad.max():7.3f} {seconds / PROFILE[-1][0]:23.4f}"
        )


def drive(robot: RobotConfig, physics_hz: int) -> tuple[np.ndarray, float]:
    """Poses (N, 3) at `ROWS_HZ`, and the wall time [s]."""
    floor = Arena("open", 4.0, 0.85, Line((), 0.015, 0.05), ())
    rates = Rates(physics_hz=physics_hz)
    begin = time.perf_counter()
    with BulletSimulation(robot, floor, (0.0, 0.0, 0.0), rates) as simulation:
        poses = [simulation.pose()]
        for (start_s, right_V, left_V), (end_s, _, _) in pairwise(PROFILE):
            simulation.set_voltages(right_V, left_V)
            for _ in range(round((end_s - start_s) * ROWS_HZ)):
                simulation.advance(physics_hz // ROWS_HZ)
                poses.append(simulation.pose())
    return np.array(poses), time.perf_counter() - begin


if __name__ == "__main__":
    main()
