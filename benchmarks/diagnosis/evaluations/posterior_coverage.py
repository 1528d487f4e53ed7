"""How often the true robot lies inside the regions of posterior.yaml, on simulated cases with known robots.

    nice -n 15 python benchmarks/diagnosis/evaluations/posterior_coverage.py --cases 120 --seed 4101

Every fourth case hides no effect, the others one; the names are taken in turn, the sizes drawn. tests/gap_cases
simulates them, which shares no code with the diagnosis (family `narrow`: noise and tolerances are as stated). The
nominal parameters of each robot are drawn from their tolerances. A case counts if the true set of effects is among the
hypotheses; the others, such as those whose effect is too small to be seen, are counted apart.

Of the hypothesis with these effects, the squared Mahalanobis distance of the true numbers, all together, must be below
the quantile of the chi-squared distribution in 50 % and 90 % of the cases, and each number alone as often inside its
own intervals. `command_timing` has no true value in these cases, and its number is left out.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import log
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from figures import interval
from hidden_cases import (
    Case,  # pyright: ignore[reportAttributeAccessIssue] - from a folder of tests
    write,  # pyright: ignore[reportAttributeAccessIssue]
)

# From a folder of tests, which `hidden_cases` puts on the path.
from gap_cases import draw_bench, make_case, names  # pyright: ignore[reportMissingImports] # isort: skip
from scipy.stats import chi2

from configs.posterior.schema import Posterior, RobotHypothesis
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.posterior.posterior import posterior

LEVELS = (0.5, 0.9)
OF_NOMINAL = {"drive.wheel_diameter_m": ("wheel_radius_m", 2.0), "drive.track_m": ("wheel_separation_m", 1.0)}
"""Parameter of a case, and factor on it, by the field of the robot."""
MIXED = {"effects.range_offset.offset_m": "range_offset_m", "effects.range_scale.scale": "range_scale"}
"""Nominal parameter that acts on the field of an effect."""


@dataclass(frozen=True)
class Covered:
    """Where the truth of one case lies."""

    kind: str
    squared: float
    """Squared Mahalanobis distance of all true numbers."""
    freedom: int
    z: tuple[float, ...]
    """Deviation of each true number in standard deviations."""


def main() -> None:
    """Diagnose the cases, and print the coverage."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=120)
    parser.add_argument("--seed", type=int, default=4101)
    parser.add_argument("--kinds", default="motor_steady,motor_step,tof_bench,drive_log")
    settings = parser.parse_args()
    kinds = settings.kinds.split(",")
    results: list[Covered] = []
    absent = 0
    for number in range(settings.cases):
        case = drawn_case(kinds[number % len(kinds)], number // len(kinds), settings.seed)
        result = covered(case)
        absent += result is None
        results += [result] if result else []
        text = f"d2 {result.squared:7.2f} of {result.freedom}" if result else "true effects not among the hypotheses"
        hidden = ", ".join(effect.variant for effect in case.world.effects) or "no effect"
        print(f"{number + 1}/{settings.cases} {case.name} {hidden}: {text}", file=sys.stderr, flush=True)
    print("\n".join(table(results, absent)))


def drawn_case(kind: str, turn: int, seed: int) -> Case:
    """Return one case of a kind."""
    case_seed = int(np.random.default_rng([seed, turn]).integers(2**31))
    library = names(draw_bench(kind, case_seed, "usual", "narrow"))
    hidden = [] if turn % 4 == 3 else [(library[turn % len(library)], None)]
    return make_case(kind, case_seed, hidden)


def covered(case: Case) -> Covered | None:
    """Return where the truth lies; None if its effects are not among the hypotheses."""
    with TemporaryDirectory() as folder:
        write(case, Path(folder) / "case")
        result = posterior(diagnose(read_measurement(Path(folder) / "case", IMPORTERS)))
    hypothesis = _true_hypothesis(result, case)
    if hypothesis is None:
        return None
    rows, deviations = [], []
    for number, row in zip(hypothesis.numbers, hypothesis.factor, strict=True):
        value = _truth(case, number.field)
        if value is not None and (number.scale == "linear" or value > 0.0):
            rows.append([*row, *[0.0] * (len(hypothesis.numbers) - len(row))])
            deviations.append((log(value) if number.scale == "log" else value) - number.mean)
    factor, deviation = np.array(rows), np.array(deviations)
    covariance = factor @ factor.T
    sd = np.sqrt(np.diag(covariance))
    scaled = covariance / np.outer(sd, sd)
    rank = int(np.count_nonzero(np.linalg.eigvalsh(scaled) > 1e-10 * len(scaled)))
    squared = float(deviation / sd @ np.linalg.pinv(scaled, rcond=1e-10, hermitian=True) @ (deviation / sd))
    return Covered(case.bench.kind, squared, rank, tuple((deviation / sd).tolist()))


def _true_hypothesis(result: Posterior, case: Case) -> RobotHypothesis | None:
    hidden = sorted(effect.variant for effect in case.world.effects)
    for hypothesis in result.hypotheses:
        names = sorted(hypothesis.name.split(" and ")) if hypothesis.name != "no effect" else []
        if names == hidden and not hypothesis.left_out:
            return hypothesis
    return None


def _truth(case: Case, field: str) -> float | None:
    """Return the true value of a field of the robot; None if there is none."""
    unit = case.world.own
    section, name = field.split(".", 1)
    if field in OF_NOMINAL:
        parameter, factor = OF_NOMINAL[field]
        return factor * unit[parameter]
    if section == "motor":
        return unit[name]
    effect, parameter = name.split(".")
    hidden = any(each.name == effect for each in case.world.effects)
    if field == "effects.range_scale.scale":
        return unit.get(MIXED[field], 1.0) * case.world.value(effect, parameter, 1.0)
    if field in MIXED:
        return unit.get(MIXED[field], 0.0) + case.world.value(effect, parameter, 0.0)
    return case.world.value(effect, parameter, 0.0) if hidden else None


def table(results: Sequence[Covered], absent: int) -> Iterator[str]:
    """Yield lines to print, with 95 % intervals after Wilson."""
    yield f"{len(results) + absent} cases; the true effects are not among the hypotheses of {absent}"
    yield f"{'kind':14s} {'cases':>5s}  {'level':>5s} {'all numbers together':>26s} {'each number alone':>26s}"
    for kind in ("all", *dict.fromkeys(result.kind for result in results)):
        selected = [result for result in results if kind in {"all", result.kind}]
        z = np.abs(np.concatenate([result.z for result in selected]))
        for level in LEVELS:
            together = sum(bool(result.squared <= chi2.ppf(level, result.freedom)) for result in selected)
            alone = int((z**2 <= chi2.ppf(level, 1)).sum())
            parts = (_share(together, len(selected)), _share(alone, len(z)))
            yield f"{kind:14s} {len(selected):5d}  {100 * level:4.0f} % {parts[0]:>26s} {parts[1]:>26s}"


def _share(count: int, total: int) -> str:
    low, high = interval(count, total)
    return f"{100 * count / total:.0f} % ({100 * low:.0f} to {100 * high:.0f})"


if __name__ == "__main__":
    main()
