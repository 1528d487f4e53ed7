"""Pose error against the physics step for the same open-loop voltages.

Twice: 10 s of starts, arcs, a turn on the spot and stops; and a whole lap, with the voltages that the wheel loop gave
in one. The reference is the smallest step. Every pose at the control rate is compared, so that no error hides in a
lucky end.

    python benchmarks/speed/step_size.py [--scenario symolo] [--route CW]
"""

import argparse
import time
from dataclasses import dataclass
from itertools import pairwise
from unittest.mock import patch

import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario, load_section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates, RunSpec
from physics.bullet.simulation import BulletSimulation
from pipeline.stages.simulate import simulate
from symolo.arena.geometry import Arena, Line


@dataclass(frozen=True)
class Voltages:
    """What both motors get: from when [s], right [V], left [V]; the last row is the end."""

    name: str
    rows: tuple[tuple[float, float, float], ...]


PROFILE = Voltages(
    "profile",
    (
        (0.0, 2.0, 2.0),
        (1.0, 2.4, 1.4),
        (3.0, 1.2, 2.2),
        (4.5, 2.0, 2.0),
        (5.5, -1.5, 1.5),
        (6.5, 0.0, 0.0),
        (7.0, 1.6, 1.6),
        (8.0, 1.0, 2.6),
        (9.0, -1.2, -1.2),
        (9.6, 0.0, 0.0),
        (10.0, 0.0, 0.0),
    ),
)
ROWS_HZ = 20
REFERENCE_HZ = 8000
RATES_HZ = (4000, 2000, 1000, 500)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--route", default="CW")
    arguments = parser.parse_args()
    report(RobotConfig.model_validate(load_section("robot", "nominal").tree), PROFILE)
    spec = draw_run(load_scenario(arguments.scenario), arguments.route, 1)
    report(spec.robot, lap_voltages(spec))


def report(robot: RobotConfig, voltages: Voltages) -> None:
    end_s = voltages.rows[-1][0]
    reference, _ = drive(robot, voltages, REFERENCE_HZ)
    length_m = np.hypot(*np.diff(reference[:, :2], axis=0).T).sum()
    turned_rad = np.abs(np.diff(reference[:, 2])).sum()
    print(f"{voltages.name}: {end_s:g} s, {length_m:.2f} m, {turned_rad:.1f} rad; reference {1e3 / REFERENCE_HZ:g} ms")
    print("step [ms]   position [mm]: end   worst   yaw [mrad]: end   worst   wall time / real time")
    for rate_hz in RATES_HZ:
        poses, seconds = drive(robot, voltages, rate_hz)
        position_mm = 1e3 * np.hypot(*(poses - reference)[:, :2].T)
        yaw_mrad = 1e3 * np.abs((poses - reference)[:, 2])
        print(
            f"{1e3 / rate_hz:9.3g} {position_mm[-1]:20.3f} {position_mm.max():7.3f}"
            f" {yaw_mrad[-1]:17.3f} {yaw_mrad.max():7.3f} {seconds / end_s:23.4f}"
        )


def lap_voltages(spec: RunSpec) -> Voltages:
    """Return the voltages of the wheel loop in the closed loop, at the scenario's own step."""
    commands: list[tuple[float, float, float]] = []
    give = BulletSimulation._drive  # noqa: SLF001 - what it gives between two control ticks stands in no log

    def give_and_note(simulation: BulletSimulation, right_V: float, left_V: float) -> None:
        give(simulation, right_V, left_V)
        commands.append((simulation.time_s, *simulation.voltages()))

    with patch.object(BulletSimulation, "_drive", give_and_note):
        outcome = simulate(spec)
    end_s = float(outcome.recording.trajectory.t_s[-1])
    rows = [row for row in commands if row[0] < end_s]
    return Voltages(f"lap of {spec.scenario} {spec.route}", (*rows, (end_s, 0.0, 0.0)))


def drive(robot: RobotConfig, voltages: Voltages, physics_hz: int) -> tuple[np.ndarray, float]:
    """Return poses (N, 3) at `ROWS_HZ`, and the wall time [s]."""
    floor = Arena("open", 8.0, 0.85, Line((), 0.015, 0.05), ())
    rates = Rates(physics_hz=physics_hz)
    row_steps = physics_hz // ROWS_HZ
    begin = time.perf_counter()
    with BulletSimulation(robot, floor, (0.0, 0.0, 0.0), rates) as simulation:
        poses = [simulation.pose()]
        for (_, right_V, left_V), (end_s, _, _) in pairwise(voltages.rows):
            simulation.set_voltages(right_V, left_V)
            end = round(end_s * physics_hz)
            while (row := len(poses) * row_steps) <= end:
                simulation.advance(row - simulation.steps)
                poses.append(simulation.pose())
            simulation.advance(end - simulation.steps)
    return np.array(poses), time.perf_counter() - begin


if __name__ == "__main__":
    main()
