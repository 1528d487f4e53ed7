"""How often a designed trial leaves one right name, beside trials with evenly spaced and with random inputs.

    python -m benchmarks.diagnosis.evaluations.next_trials --kind motor_steady --cases 200 --seed 501 --out result.json

The cases come from `independent_cases`, whose simulator shares no code with symolo. Those with one listed effect, of
which little remains beside another name (a likelihood ratio below `NEAR`), are diagnosed; where two or more names
remain, the same robot is measured again, once for each method to choose the inputs: the designed trial, and evenly
spaced and random inputs of the same time and of three times the time. Each new trial is diagnosed together with the old
case. The result is right if the named effects are the hidden ones, and no name is ambiguous. A row of a bench takes 1
s, which is at least four time constants of these motors.

    python -m benchmarks.diagnosis.evaluations.next_trials --kind motor_steady --seed 401 --cases 60 --number 44 \\
        --fill next/trial_1

measures a trial that `symolo next` has designed: it fills the readings of its data.csv from the robot of one case.
"""

import argparse
import json
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.stats import beta

from benchmarks.diagnosis.independent_cases.case import KINDS, NEAR, deal_cases, draw_case
from benchmarks.diagnosis.independent_cases.files import write_case
from benchmarks.diagnosis.independent_cases.recipes import variant_of
from benchmarks.diagnosis.independent_cases.setting import Setting
from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.measurement import Measurement
from diagnosis.next_trial.design import design_trial
from diagnosis.next_trial.limits import limits_of
from diagnosis.together import together
from symolo.core.errors import InputError
from symolo.core.random_streams import stream

SECONDS, ROW_S = 15.0, 1.0
METHODS = ("designed", "even", "random", "even, 3 times", "random, 3 times")


@dataclass(frozen=True)
class Inputs:
    """Inputs of a trial on a bench, (N,) each."""

    columns: Mapping[str, np.ndarray]
    materials: np.ndarray | None
    t_s: np.ndarray


def inputs_of(measurement: Measurement) -> Inputs:
    """Return the inputs of a designed trial."""
    (trial,) = measurement.trials
    columns = {channel.name: channel.values for channel in trial.channels if np.isfinite(channel.values).any()}
    materials = np.array(trial.labels[0].values) if trial.labels else None
    return Inputs(columns, materials, trial.t_s)


def motor_inputs(setting: Setting, method: str, rng: np.random.Generator) -> Inputs:
    """Return evenly spaced or random voltages in both directions."""
    rows = round(SECONDS / ROW_S) * (3 if "3 times" in method else 1)
    top = setting.top_voltage_V
    if method.startswith("even"):
        up = np.linspace(0.0, top, rows // 2 + 2)[1:]
        values = np.concatenate([up, -up])[:rows]
    else:
        values = rng.uniform(-top, top, rows)
    return Inputs({"u_cmd_V": np.round(values, 3)}, None, ROW_S * np.arange(1.0, rows + 1.0))


def range_inputs(setting: Setting, method: str, rng: np.random.Generator) -> Inputs:
    """Return evenly spaced or random distances with random materials and random conditions of the old bench."""
    rows = round(SECONDS / ROW_S) * (3 if "3 times" in method else 1)
    old = setting.bench
    near, far = old.distance_m.min(), old.distance_m.max()
    distance = np.linspace(near, far, rows) if method.startswith("even") else rng.uniform(near, far, rows)
    columns = {"distance_m": np.round(distance, 3)}
    columns |= {
        name: rng.choice(values, rows)
        for name, values in (
            ("incidence_rad", old.incidence_rad),
            ("temperature_C", old.temperature_C),
            ("ambient_lux", old.lux),
        )
    }
    return Inputs(columns, rng.choice(sorted(setting.reflectance), rows), ROW_S * np.arange(1.0, rows + 1.0))


def measured(setting: Setting, inputs: Inputs) -> Setting:
    """Return a setting of the same robot with other inputs, all for the fit."""
    other = copy(setting)
    rows = len(inputs.t_s)
    other.holdout = np.zeros(rows, bool)
    if setting.KIND == "motor_steady":
        other.u_V, other.t_s, other.sweep = inputs.columns["u_cmd_V"], inputs.t_s, np.ones(rows, int)
        return other
    reflectance = np.array([setting.reflectance[name] for name in inputs.materials])
    other.bench = replace(
        setting.bench,
        distance_m=inputs.columns["distance_m"],
        material=inputs.materials,
        incidence_rad=inputs.columns["incidence_rad"],
        temperature_C=inputs.columns["temperature_C"],
        lux=inputs.columns["ambient_lux"],
        t_s=inputs.t_s,
        reflectance=reflectance,
    )
    return other


def read(files: object, name: str, folder: Path) -> Measurement:
    """Return a case as the diagnosis reads it."""
    write_case(folder / name, files)
    return read_measurement(folder / name, IMPORTERS)


def state(diagnosis: Diagnosis, truth: set[str]) -> dict:
    """Return the names, those that remain beside them, and whether one right name remains for each effect."""
    names = {named.name for named in diagnosis.named}
    others = [other for named in diagnosis.named for other in named.comparison.ambiguous_with]
    return {
        "names": sorted(names),
        "others": others,
        "right": names == truth and not others,
        "wrong": bool(names - truth),
        "truth_among": truth <= names | {other.split("[")[0] for other in others},
    }


def evaluation(kind: str, cases: int, seed: int) -> Iterator[dict]:
    """Yield the result of each case whose first diagnosis leaves two or more names."""
    for number, (category, names, rng) in enumerate(deal_cases(kind, cases, seed), 1):
        if category != "one":
            continue
        drawn, _ = draw_case(KINDS[kind], category, names, rng)
        if min(drawn.rivals.values(), default=np.inf) >= NEAR:
            continue
        variant = variant_of(drawn.sized)
        with tempfile.TemporaryDirectory() as folder:
            old = read(drawn.setting.produce(variant, rng), "old", Path(folder))
            first = diagnose(old)
            before = state(first, set(names))
            if not before["others"]:
                continue
            result = {"case": f"{kind} {seed} {number}", "truth": names, "before": before}
            try:
                design = design_trial(first, limits_of(old, seconds=SECONDS, row_s=ROW_S))
            except InputError as error:
                yield {**result, "refused": str(error)}
                continue
            smallest = design.expected.smallest
            result["expected"] = design.expected.one_right
            result["separation"] = None if smallest is None else smallest.separation
            draw_inputs = motor_inputs if kind == "motor_steady" else range_inputs
            for method in METHODS:
                draws = stream(seed, number, method)
                inputs = inputs_of(design.trial) if method == "designed" else draw_inputs(drawn.setting, method, draws)
                files = measured(drawn.setting, inputs).produce(variant, draws)
                new = read(files, method.replace(",", "").replace(" ", "_"), Path(folder))
                result[method] = state(diagnose(together([old, new])), set(names))
            yield result


def trial_files(trial: Path, kind: str, cases: int, seed: int, number: int) -> object:
    """Return the files of a designed trial, measured with the robot of a case; `number` counts from 1."""
    category, names, rng = list(deal_cases(kind, cases, seed))[number - 1]
    drawn, _ = draw_case(KINDS[kind], category, names, rng)
    variant = variant_of(drawn.sized)
    inputs = inputs_of(read_measurement(trial, IMPORTERS))
    return measured(drawn.setting, inputs).produce(variant, stream(seed, number, "fill"))


def fill(trial: Path, files: object) -> None:
    """Fill the data.csv of a designed trial with that of the files of the generator."""
    with tempfile.TemporaryDirectory() as folder:
        write_case(Path(folder), files)
        (trial / "data.csv").write_bytes((Path(folder) / "data.csv").read_bytes())


def interval(hits: int, total: int) -> tuple[float, float]:
    """Return the 90 % interval of a share (Clopper and Pearson, Biometrika 26 (1934) 404-413)."""
    low = beta.ppf(0.05, hits, total - hits + 1) if hits else 0.0
    high = beta.ppf(0.95, hits + 1, total - hits) if hits < total else 1.0
    return float(low), float(high)


def table(results: list[dict]) -> Iterator[str]:
    """Yield the lines of the table of all cases, and of those that can be distinguished."""
    designed = [each for each in results if "refused" not in each]
    yield f"{len(results)} cases with two or more names, {len(designed)} with a trial"
    groups = {
        "all": designed,
        "separation of at least 3 standard deviations": [e for e in designed if (e["separation"] or 0.0) >= 3.0],
        "less": [e for e in designed if (e["separation"] or 0.0) < 3.0],
    }
    yield from lines_of_groups(groups, METHODS)


def lines_of_groups(groups: Mapping[str, Sequence[dict]], methods: Collection[str]) -> Iterator[str]:
    """Yield how often each method to choose a trial leaves one right name, for each group of cases that has any."""
    width = max(map(len, methods))
    for title, group in groups.items():
        if not group:
            continue
        expected = sum(each["expected"] for each in group) / len(group)
        yield f"{title}: {len(group)} cases; one right name expected in {expected:.0%}"
        for method in methods:
            right, wrong = (sum(each[method][key] for each in group) for key in ("right", "wrong"))
            low, high = interval(right, len(group))
            yield f"  {method:{width}} one right name {right:3d} ({low:.0%} to {high:.0%}), a wrong name {wrong:3d}"


def main() -> None:
    """Run the evaluation and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", choices=("motor_steady", "tof_bench"), default="motor_steady")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file for the result of each case")
    parser.add_argument("--fill", type=Path, metavar="TRIAL", help="trial of symolo next to measure")
    parser.add_argument("--number", type=int, default=1, help="case whose robot is measured, from 1")
    args = parser.parse_args()
    if args.fill:
        fill(args.fill, trial_files(args.fill, args.kind, args.cases, args.seed, args.number))
        return
    results = []
    for result in evaluation(args.kind, args.cases, args.seed):
        results.append(result)
        print(json.dumps(result), flush=True)
        if args.out:
            args.out.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(*table(results), sep="\n")


if __name__ == "__main__":
    main()
