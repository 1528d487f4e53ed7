"""Errors of predictions outside the range in which an effect was seen, beside their standard deviations.

    python benchmarks/diagnosis/evaluations/beyond_range.py --benches 100 --drives 10 --seed 1

From each motor bench of our generator the diagnosis gets the rows up to half the highest voltage, and predicts currents
and speeds of the others. There the law of the hidden effect goes on, or it becomes another one (`LAWS`). The program
counts how many readings lie within the 95 % interval, without the part of the error for an unknown law and with it, and
by how much that part widens the intervals.

The drives are those of a robot that is fitted to slow arcs, straight lines and turns on the spot, and then drives
freely, up to 0.15 m/s and 1 rad/s. Either it slips in turns as the law says (`turn_slip`), or its wheels are further
apart on arcs for another reason, so that the law only describes these.
"""

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path

import numpy as np
import yaml
from hidden_cases import Case, make_case, write
from numpy.typing import NDArray

from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.cases.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.prediction_error import UnseenPrediction, predictions

Array = NDArray[np.float64]
SEEN_V = 2.5
NORMAL_95 = 1.96
LAWS = {
    "the law goes on": lambda d: 1.0 + 0.0 * d,
    "it grows no more": lambda d: 1.0 / (1.0 + d),
    "it grows by one power more": lambda d: 1.0 + d,
    "it is absent beyond the range": lambda d: 0.0 * d,
}
"""Size of the hidden effect at a relative distance beyond the voltages that were seen, over what its law says."""
HIDDEN = (
    "quadratic_drag",
    "viscous_friction_scale",
    "coulomb_friction_scale",
    "supply_sag",
    "winding_resistance_scale",
    "torque_constant_scale",
    "bridge_voltage_drop",
    "current_sensor_gain",
    "speed_scale",
    "bridge_coast",
)
ROW_S, TICKS, DIAMETER_M, TRACK_M = 0.05, 2796.8, 0.084, 0.2
XY_M, THETA_RAD, SLIP_M_PER_SQRT_M = 4e-4, 2e-3, 1e-3


@dataclass
class Coverage:
    """Readings within their 95 % intervals."""

    inside: int = 0
    inside_plain: int = 0
    """Within the intervals without the part for an unknown law."""
    total: int = 0
    widening: float = 0.0
    """Sum of the ratios of both standard deviations."""

    def add(self, errors: Array, sds: Array, plain: Array) -> None:
        known = np.isfinite(errors)
        self.inside += int(np.sum(np.abs(errors[known]) < NORMAL_95 * sds[known]))
        self.inside_plain += int(np.sum(np.abs(errors[known]) < NORMAL_95 * plain[known]))
        self.total += int(np.sum(known))
        self.widening += float(np.sum(sds[known] / plain[known]))

    def line(self, title: str) -> str:
        if not self.total:
            return f"{title:32} no predictions"
        plain, whole = 100.0 * self.inside_plain / self.total, 100.0 * self.inside / self.total
        return f"{title:32} {plain:6.1f} % {whole:6.1f} % {self.widening / self.total:8.1f} times"


def both(diagnosis: Diagnosis, unseen: Mapping) -> tuple[UnseenPrediction, UnseenPrediction]:
    """Return the predictions of one file with the whole error, and without the part for an unknown law."""
    (whole,), (plain,) = (predictions(each, unseen) for each in (diagnosis, replace(diagnosis, named=())))
    return whole, plain


def benches(count: int, seed: int) -> Iterator[str]:
    """Yield the lines of the table of benches."""
    coverage = {law: Coverage() for law in LAWS}
    named = 0
    for number in range(count):
        case = make_case("motor_steady", 1000 * seed + number, [(HIDDEN[number % len(HIDDEN)], None)])
        diagnosis, unseen = diagnosis_of_slow_rows(case)
        if not diagnosis.named:
            continue
        named += 1
        whole, plain = both(diagnosis, unseen)
        rng = np.random.default_rng([seed, number])
        for law in LAWS:
            for name, values in readings(case, law, rng).items():
                errors = values - whole.columns[name]
                coverage[law].add(errors, whole.columns[f"sd_{name}"], plain.columns[f"sd_{name}"])
    yield f"{count} benches, {named} with a name"
    yield from (coverage[law].line(law) for law in LAWS)


def diagnosis_of_slow_rows(case: Case) -> tuple[Diagnosis, Mapping]:
    """Return the diagnosis of the rows with low voltages, and the others as an unseen run."""
    slow = np.abs(case.columns["u_cmd_V"]) <= SEEN_V
    seen = replace(
        case,
        bench=replace(case.bench, inputs={name: values[slow] for name, values in case.bench.inputs.items()}),
        columns={name: values[slow] for name, values in case.columns.items()},
        blind={"blind_inputs.csv": fast_inputs(case)},
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case"
        write(seen, path)
        measurement = read_measurement(path, IMPORTERS)
        return diagnose(measurement), read_blind(path, measurement.kind)


def fast_inputs(case: Case) -> Mapping[str, NDArray]:
    fast = np.abs(case.columns["u_cmd_V"]) > SEEN_V
    return {name: case.columns[name][fast] for name in ("row", "t_s", "u_cmd_V")}


def readings(case: Case, law: str, rng: np.random.Generator) -> dict[str, Array]:
    """Return noisy readings at high voltages, where the hidden effect follows a law."""
    bench, inputs = import_module("gap_cases.motor_steady"), fast_inputs(case)
    factors = LAWS[law](np.abs(inputs["u_cmd_V"]) / SEEN_V - 1.0).tolist()
    worlds = [replace(case.world, effects=tuple(scaled(each, f) for each in case.world.effects)) for f in factors]
    current, speed = (np.diag(values) for values in bench.mean(case.bench, inputs, worlds))
    noise = case.bench.nominal["noise"]
    means = {"current_A": current, "omega_rad_s": speed}
    return {name: mean + noise[name] * rng.standard_normal(len(mean)) for name, mean in means.items()}


def scaled(effect, factor: float):  # noqa: ANN001, ANN201 - of a package that is found by its path
    """Return an effect of another size; 0 stands for none."""
    name = next(iter(effect.parameters))
    neutral = 1.0 if name in {"scale", "gain"} else 0.0
    value = neutral + factor * (float(effect.parameters[name]) - neutral)
    return replace(effect, parameters={**effect.parameters, name: value})


def drives(count: int, seed: int) -> Iterator[str]:
    """Yield the lines of the table of drives."""
    truths = {"turn_slip": Coverage(), "wider on arcs, on this day": Coverage()}
    ends = {truth: [] for truth in truths}
    for number in range(count):
        rng = np.random.default_rng([seed, number, 7])
        size = rng.uniform(1.5, 3.0)
        for truth, coverage in truths.items():
            slips = truth == "turn_slip"
            runs = [*arcs(rng), *lines_and_turns(rng)]
            tracks = [TRACK_M * (1.0 if slips or not is_arc else 1.0 + 0.0086 * size) for _, _, is_arc in runs]
            logs = [
                log(rng, v, w, track, size if slips else 0.0) for (v, w, _), track in zip(runs, tracks, strict=True)
            ]
            free = log(rng, *joystick(rng), TRACK_M, size if slips else 0.0)
            predictions = fitted(logs, free)
            if predictions is None:
                continue
            whole, plain = predictions
            for k, name in enumerate(("x_m", "y_m", "theta_rad")):
                errors = free[:, 2 + k] - whole.columns[name]
                coverage.add(errors, whole.columns[f"sd_{name}"], plain.columns[f"sd_{name}"])
            ends[truth].append([whole.columns[f"{sd}{name}"][-1] for sd in ("", "sd_") for name in ("x_m", "y_m")])
            ends[truth][-1] += [free[-1, 2], free[-1, 3]]
    for truth, coverage in truths.items():
        yield coverage.line(truth)
        if ends[truth]:
            x, y, sd_x, sd_y, true_x, true_y = np.array(ends[truth]).T
            error, sd = np.hypot(x - true_x, y - true_y), np.hypot(sd_x, sd_y)
            yield (
                f"{'':32} at the end {1e3 * np.sqrt(np.mean(error**2)):.0f} mm rms, stated "
                f"{1e3 * np.sqrt(np.mean(sd**2)):.0f} mm; {len(error)} drives with the name"
            )


def arcs(rng: np.random.Generator) -> list[tuple[Array, Array, bool]]:
    """Return speeds [m/s] and turn rates [rad/s] of runs along two half circles, either way round."""
    runs = []
    for k in range(6):
        rows = int(rng.integers(600, 800))
        turn = 0.16 * np.where(np.arange(rows) < rows // 2, 1.0, -1.0) * (-1.0) ** k
        runs.append((np.full(rows, 0.0565), turn, True))
    return runs


def lines_and_turns(rng: np.random.Generator) -> list[tuple[Array, Array, bool]]:
    """Return straight lines with turns on the spot."""
    runs = []
    for k in range(6):
        legs = [(0.057, 0.0, 100), (0.0, 0.31 * (-1.0) ** k, round(0.5 * np.pi / 0.31 / ROW_S))] * 4
        v, w = (np.concatenate([np.full(leg[2], leg[i]) for leg in legs]) for i in (0, 1))
        runs.append((v, w + 0.002 * rng.standard_normal(len(w)), False))
    return runs


def joystick(rng: np.random.Generator) -> tuple[Array, Array]:
    """Return a free drive of a minute: levels that are held for a second or two and then reached smoothly."""
    rows, v, w = 1200, [], []
    while len(v) < rows:
        length = int(rng.integers(20, 50))
        v += [rng.uniform(0.05, 0.15)] * length
        w += [rng.uniform(-0.97, 0.97)] * length
    smooth = np.ones(10) / 10.0
    return np.convolve(v[:rows], smooth, "same"), np.convolve(w[:rows], smooth, "same")


def log(rng: np.random.Generator, v: Array, w: Array, track_m: float, slip_s2_m: float) -> Array:
    """Return ticks of the left and the right wheel and noisy poses of a drive, (n, 5), with wheels so far apart.

    The wheels turn as v and w command. Each of them slips by a millimetre per root of a metre at random, and the body
    turns less by 1 / (1 + slip |v w|).
    """
    travel = ROW_S * np.stack([v - 0.5 * TRACK_M * w, v + 0.5 * TRACK_M * w], axis=1)
    left, right = (travel + SLIP_M_PER_SQRT_M * np.sqrt(np.abs(travel)) * rng.standard_normal(travel.shape)).T
    turn = (right - left) / track_m / (1.0 + slip_s2_m * np.abs(v * w))
    yaw = np.concatenate([[0.0], np.cumsum(turn)])
    middle = yaw[1:] - 0.5 * turn
    x, y = (np.concatenate([[0.0], np.cumsum(0.5 * (left + right) * course(middle))]) for course in (np.cos, np.sin))
    ticks = np.rint(np.cumsum(np.concatenate([np.zeros((1, 2)), travel]), axis=0) * TICKS / np.pi / DIAMETER_M)
    poses = np.stack([x, y, yaw], axis=1) + np.array([XY_M, XY_M, THETA_RAD]) * rng.standard_normal((len(x), 3))
    return np.concatenate([ticks, poses], axis=1)


def fitted(logs: Sequence[Array], free: Array) -> tuple[UnseenPrediction, UnseenPrediction] | None:
    """Return the predictions of a free drive by a robot that was fitted to logs; None if `turn_slip` is not named."""
    header = "trial,split,session_time_s,t_s,enc_left_ticks,enc_right_ticks,x_m,y_m,theta_rad"
    lines, begin = [header], 0.0
    for number, rows in enumerate(logs, 1):
        split = "holdout" if number % 4 == 0 else "fit"
        for k, row in enumerate(rows):
            time = ROW_S * k
            lines.append(f"{number},{split},{begin + time:.2f},{time:.2f},{cells(row)}")
        begin += ROW_S * len(rows)
    unseen = ["session_time_s,t_s,enc_left_ticks,enc_right_ticks,x_m,y_m,theta_rad"]
    for k, row in enumerate(free):
        pose = cells(row) if k == 0 else f"{row[0]:.0f},{row[1]:.0f},,,"
        unseen.append(f"{begin + ROW_S * k:.2f},{ROW_S * k:.2f},{pose}")
    nominal = {
        "kind": "drive_log",
        "robot": {
            "wheel_radius_m": {"value": 0.5 * DIAMETER_M, "tolerance": 2.5e-4},
            "wheel_separation_m": {"value": TRACK_M, "tolerance": 2e-3},
            "encoder_ticks_per_revolution": TICKS,
        },
        "noise": {
            "wheel_speed_rad_s": 0.05,
            "pose_xy_m": XY_M,
            "pose_theta_rad": THETA_RAD,
            "travel_m_per_sqrt_m": SLIP_M_PER_SQRT_M,
            "tof_polynomial_mm": [1.4, 4.88, 2.51, 1.15],
            "tof_polynomial_origin_m": 0.18,
        },
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case"
        path.mkdir()
        (path / "nominal.yaml").write_text(yaml.safe_dump(nominal))
        (path / "data.csv").write_text("\n".join(lines) + "\n")
        (path / "blind_pose_inputs.csv").write_text("\n".join(unseen) + "\n")
        measurement = read_measurement(path, IMPORTERS)
        diagnosis = diagnose(measurement)
        if "turn_slip" not in [named.name for named in diagnosis.named]:
            return None
        return both(diagnosis, read_blind(path, measurement.kind))


def cells(row: Array) -> str:
    return f"{row[0]:.0f},{row[1]:.0f},{row[2]:.6f},{row[3]:.6f},{row[4]:.6f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--benches", type=int, default=100)
    parser.add_argument("--drives", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(f"{'within the 95 % interval':32} {'plain':>8} {'whole':>8} {'wider':>14}")
    for line in (*benches(arguments.benches, arguments.seed), *drives(arguments.drives, arguments.seed)):
        print(line, flush=True)


if __name__ == "__main__":
    main()
