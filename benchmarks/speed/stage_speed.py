"""Time that the stages of a measured case take to predict it by many robots at once, on one core.

    python benchmarks/speed/stage_speed.py CASE... [--robots 20]

Of each stage, with the nominal robot's numbers varied by a per cent, bare and with one effect each that acts on it.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from time import process_time

import numpy as np

from configs.draw import draw_robot
from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.nominal import NominalTof
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Stage

BY_NAME = EFFECTS.by_name()
REPEATS = 5


def varied(robot: RobotConfig, robots: int) -> list[RobotConfig]:
    """Return copies of a robot with another winding, friction, inertia and geometry each."""
    rng = np.random.default_rng(1)
    changed = []
    for factors in 1.0 + 0.01 * rng.standard_normal((robots, 7)):
        motor = ("winding_resistance_ohm", "torque_constant_N_m_A", "coulomb_friction_N_m", "rotor_inertia_kg_m2")
        numbers = {name: getattr(robot.motor, name) * f for name, f in zip(motor, factors[:4], strict=True)}
        drive = {"track_m": robot.drive.track_m * factors[4], "wheel_diameter_m": robot.drive.wheel_diameter_m}
        sections = {
            "motor": robot.motor.model_copy(update=numbers),
            "drive": robot.drive.model_copy(update=drive),
        }
        changed.append(robot.model_copy(update=sections))
    return changed


def milliseconds(stage: Stage, robots: Sequence[RobotConfig]) -> float:
    """Return the shortest of several processor times, since other work on the machine only adds to them."""
    times = []
    for _ in range(REPEATS):
        begin = process_time()
        stage.predict(robots)
        times.append(process_time() - begin)
    return 1e3 * min(times)


def changes_prediction(stage: Stage, robots: Sequence[RobotConfig], with_effect: Sequence[RobotConfig]) -> bool:
    """Return whether an effect changes what the stage predicts."""
    both = (stage.predict(several[:1]) for several in (robots, with_effect))
    return any(
        not np.array_equal(a.mean, b.mean, equal_nan=True) or not np.array_equal(a.sd, b.sd)
        for a, b in zip(*both, strict=True)
    )


def report(path: Path, robots: int) -> None:
    measurement = read_measurement(path, IMPORTERS)
    base_robot = draw_robot(load_section("robot", "nominal"), 1, "benchmark")[0]
    nominal = nominal_robot(measurement.nominal, base_robot) if measurement.nominal else base_robot
    begin = process_time()
    stages = STAGES[measurement.kind](measurement, nominal)
    print(f"{path.name}: {measurement.rows} rows, bound in {1e3 * (process_time() - begin):.0f} ms")
    for stage in stages:
        bare = varied(nominal, robots)
        print(f"  {stage.name}, {robots} robots: bare {milliseconds(stage, bare):.1f} ms")
        for effect in BY_NAME.values():
            if effect.slot is Slot.GEARBOX and stage.name == "wheels":
                continue
            choices = {
                name: (any_of or (_material(measurement.nominal),))[0] for name, any_of in effect.options().items()
            }
            several = [robot.with_effect(effect.start(choices)) for robot in bare]
            if changes_prediction(stage, bare, several):
                print(f"    {effect.name} {milliseconds(stage, several):.1f} ms")


def _material(nominal: object) -> str:
    return next(iter(nominal.tof.reflectance)) if isinstance(nominal, NominalTof) else "white_board"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="+", type=Path)
    parser.add_argument("--robots", type=int, default=20)
    arguments = parser.parse_args()
    for case in arguments.cases:
        report(case, arguments.robots)
