"""Names that a diagnosis gives where nothing is hidden, for logs of controllers that run at 100 to 500 Hz.

    python benchmarks/diagnosis/evaluations/controller_logs.py --logs 30 --seed 1 [--poses] [--json FILE]

Each log is that of a robot whose motors obey the textbook model exactly. A controller changes both voltages many times
within the twentieth of a second to which `symolo case init` samples a log again: it holds steps of the voltage or of
the speed, brakes and reverses. The log has a row at each cycle of the controller: time in milliseconds, voltages,
encoder counts, and with `--poses` those of a camera. The program makes a case of it, as `symolo case init` does with
the robot's own numbers, and diagnoses the case. The motion is integrated here, with no model of ours.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT))

from diagnosis.diagnose import Diagnosis, diagnose  # noqa: E402 - by the path above
from diagnosis.new_case.new_case import new_case  # noqa: E402
from diagnosis.new_case.proposal import propose  # noqa: E402
from logs.log_file import read_log  # noqa: E402

Array = NDArray[np.float64]
STEP_S = 2.5e-4
SECONDS = 30.0
SUPPLY_V = 7.4
TICKS, DIAMETER_M, TRACK_M = 1440.0, 0.065, 0.14
PI_GAIN_V_S, PI_TIME_S = 0.35, 0.12
"""Proportional gain [V s/rad] and integral time of the speed loop."""


@dataclass(frozen=True)
class Robot:
    """Motors at the wheel, each with half of the robot's inertia; arrays are (2,), left and right."""

    resistance_ohm: Array
    constant: Array
    viscous: Array
    coulomb_N_m: Array
    inertia_kg_m2: Array

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "tuple[Robot, Mapping[str, float]]":
        """Return a robot whose motors differ from the numbers that are known by usual tolerances, and these numbers."""
        known = {
            "winding_resistance_ohm": rng.uniform(2.0, 6.0),
            "torque_constant_N_m_A": rng.uniform(0.2, 0.4),
            "viscous_friction_N_m_s_rad": rng.uniform(0.001, 0.003),
            "coulomb_friction_N_m": rng.uniform(0.01, 0.04),
            "rotor_inertia_kg_m2": rng.uniform(0.002, 0.005),
        }
        shares = (0.03, 0.02, 0.15, 0.1, 0.03)
        drawn = [
            value * (1.0 + share * rng.standard_normal()) for value, share in zip(known.values(), shares, strict=True)
        ]
        return cls(*(np.full(2, value) for value in drawn)), known


def set_points(rng: np.random.Generator, *, is_speed: bool) -> Array:
    """Return the set points (N, 2) of both wheels at every step: levels that are held for 0.3 to 2 s."""
    steps = round(SECONDS / STEP_S)
    targets, at = np.zeros((steps, 2)), round(0.2 / STEP_S)
    while at < steps:
        high = 9.0 if is_speed else 4.5
        both = rng.uniform(0.25, 1.0) * high * rng.choice([1.0, 1.0, 1.0, -1.0])
        kind = rng.random()
        level = (both, both * rng.uniform(0.5, 1.0)) if kind < 0.6 else (both, -both) if kind < 0.8 else (0.0, 0.0)
        length = round(rng.uniform(0.3, 2.0) / STEP_S)
        targets[at : at + length] = level
        at += length
    return targets


def drive(robot: Robot, rng: np.random.Generator, rate_hz: int, *, is_speed: bool) -> tuple[Array, Array]:
    """Return voltages that begin at each cycle of the controller and wheel angles there, (T, 2) each."""
    per_cycle = round(1.0 / rate_hz / STEP_S)
    targets = set_points(rng, is_speed=is_speed)
    speed, angle, integral, before = (np.zeros(2) for _ in range(4))
    volts, voltages, angles = np.zeros(2), [], []
    for step in range(len(targets)):
        if step % per_cycle == 0:
            counts = np.floor(angle * TICKS / (2.0 * np.pi))
            if is_speed:
                seen = (counts - before) * 2.0 * np.pi / TICKS * rate_hz
                error = targets[step] - seen
                raw = PI_GAIN_V_S * (error + integral) + robot.constant * targets[step]
                volts = np.clip(raw, -SUPPLY_V, SUPPLY_V)
                integral = np.where(raw == volts, integral + error / rate_hz / PI_TIME_S, integral)
                volts = np.where(targets[step] == 0.0, 0.0, volts)
            else:
                volts = targets[step]
            volts = np.asarray(np.round(volts, 3), dtype=np.float64)
            before = counts
            voltages.append(volts)
            angles.append(angle)
        speed, turned = moved(robot, speed, volts)
        angle = angle + turned
    return np.array(voltages), np.array(angles)


def moved(robot: Robot, speed: Array, volts: Array) -> tuple[Array, Array]:
    """Return speeds and turns after a step of the midpoint rule; dry friction holds a wheel at rest."""

    def acceleration(w: Array) -> Array:
        drive = robot.constant * (volts - robot.constant * w) / robot.resistance_ohm
        direction = np.where(w == 0.0, np.sign(drive), np.sign(w))
        held = (w == 0.0) & (np.abs(drive) <= robot.coulomb_N_m)
        free = (drive - robot.viscous * w - robot.coulomb_N_m * direction) / robot.inertia_kg_m2
        return np.where(held, 0.0, free)

    half = speed + 0.5 * STEP_S * acceleration(speed)
    half = np.where(speed * half < 0.0, 0.0, half)
    after = speed + STEP_S * acceleration(half)
    after = np.where(speed * after < 0.0, 0.0, after)
    return after, 0.5 * STEP_S * (speed + after)


def log_text(rng: np.random.Generator, rate_hz: int, voltages: Array, angles: Array, *, poses: bool) -> str:
    """Return the text of the log."""
    counts = np.floor(angles * TICKS / (2.0 * np.pi)).astype(int)
    columns = {
        "time_ms": [f"{1e3 * k / rate_hz:.6g}" for k in range(len(voltages))],
        "motor_left [V]": [f"{v:.3f}" for v in voltages[:, 0]],
        "motor_right [V]": [f"{v:.3f}" for v in voltages[:, 1]],
        "encL": [str(n) for n in counts[:, 0]],
        "encR": [str(n) for n in counts[:, 1]],
    }
    if poses:
        travel = 0.5 * DIAMETER_M * np.diff(angles, axis=0, prepend=angles[:1])
        turn = (travel[:, 1] - travel[:, 0]) / TRACK_M
        heading = np.cumsum(turn)
        forward, middle = travel.mean(axis=1), heading - 0.5 * turn
        place = [np.cumsum(forward * course(middle)) for course in (np.cos, np.sin)]
        noisy = [
            each + sd * rng.standard_normal(len(each))
            for each, sd in ((place[0], 1e-3), (place[1], 1e-3), (heading, 3e-3))
        ]
        columns |= {
            name: [f"{v:.5f}" for v in values]
            for name, values in zip(("x_m", "y_m", "heading_rad"), noisy, strict=True)
        }
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(row) for row in rows)]) + "\n"


@dataclass(frozen=True)
class Outcome:
    number: int
    rate_hz: int
    is_speed: bool
    diagnosis: Diagnosis
    seconds: float

    @property
    def names(self) -> list[str]:
        return [named.effect.name for named in self.diagnosis.named]

    def line(self) -> str:
        """Return the outcome in one line."""
        named = [
            f"{each.effect.name} {list(each.values.values())} ({each.comparison.confidence:.0%})"
            for each in self.diagnosis.named
        ]
        control = "speed loop" if self.is_speed else "open loop"
        text = f"{'; '.join(named) or 'nothing'} - {self.diagnosis.conclusion.value}"
        where = self.diagnosis.unexplained
        text += f", {where.observed} along {where.covariate}" if where else ""
        return f"{self.number:3}  {self.rate_hz:3} Hz, {control:10}  {self.seconds:5.1f} s  {text}"


def outcome(number: int, seed: int, *, poses: bool) -> Outcome:
    """Return the diagnosis of one log."""
    rng = np.random.default_rng([seed, number])
    rate_hz = int(rng.choice([100, 200, 250, 500]))
    is_speed = bool(number % 2)
    robot, known = Robot.drawn(rng)
    voltages, angles = drive(robot, rng, rate_hz, is_speed=is_speed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        path.write_text(log_text(rng, rate_hz, voltages, angles, poses=poses))
        log = read_log(path)
        case = new_case(log, propose(log).mapping, "case")
        geometry = {"wheel_diameter_m": DIAMETER_M, "track_m": TRACK_M} if poses else {}
        numbers = {**known, "supply_voltage_V": SUPPLY_V, "ticks_per_turn": TICKS, **geometry}
        measurement = case.knowing(numbers).write(Path(folder) / "case")
        begin = process_time()
        return Outcome(number, rate_hz, is_speed, diagnose(measurement), process_time() - begin)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--logs", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first log")
    parser.add_argument("--poses", action="store_true")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = []
    for number in range(arguments.first, arguments.first + arguments.logs):
        result = outcome(number, arguments.seed, poses=arguments.poses)
        print(result.line(), flush=True)
        rows.append({"number": number, "names": result.names, "conclusion": result.diagnosis.conclusion.value})
        if arguments.json:
            arguments.json.write_text(json.dumps(rows))
    wrong = sum(bool(row["names"]) for row in rows)
    unexplained = sum(row["conclusion"] in {"unexplained", "named in part"} for row in rows)
    print(f"{wrong} of {len(rows)} logs with a name, {unexplained} with unexplained structure")


if __name__ == "__main__":
    main()
