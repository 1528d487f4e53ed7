"""What a test that knows the true model could see, from the likelihood ratios (LR) in truth.json.

The test compares the true model with the same one without one of its effects, with the true noise and without outliers.
Twice the log of the ratio is then noncentral chi-square with the LR as noncentrality, and with a degree of freedom for
each number of the effect. Its threshold names an effect by chance in FALSE_ALARMS of the cases with nothing hidden,
over all names of the list together. No diagnosis of the same rows can miss fewer effects with as few false names. One
that must learn noise and outliers from the rows misses more. For range benches, the share is also stated for a test
that knows the noise to a factor of two only (`ranges/unknown_noise.py`).
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import chndtr
from scipy.stats import chi2

from benchmarks.diagnosis.independent_cases.case import KINDS
from benchmarks.diagnosis.independent_cases.ranges import unknown_noise
from benchmarks.diagnosis.independent_cases.ranges.tof_bench import RangeSetting

FALSE_ALARMS = 0.01


def missed(effect: dict[str, Any], names: int) -> float:
    """Return the probability that the test misses an effect, which is one of so many names."""
    numbers = sum(isinstance(value, float) for value in effect["parameters"].values()) or 1
    threshold = chi2.isf(FALSE_ALARMS / names, numbers)
    return float(chndtr(threshold, numbers, effect["lr"]))


def run(truth_path: Path) -> None:
    """Print the share of cases of each kind in which the test sees all effects."""
    truths = json.loads(truth_path.read_text(encoding="utf-8"))
    for kind, setting in KINDS.items():
        names = len(setting.PLACE)
        for category, hidden in (("one", "one effect"), ("two", "both of two")):
            cases = [t for t in truths if t["kind"] == kind and t["category"] == category]
            if cases:
                seen = [float(np.prod([1.0 - missed(effect, names) for effect in t["effects"]])) for t in cases]
                print(f"{kind:13s} {hidden:12s} {len(cases):4d} cases  {np.mean(seen):.1%} could be seen")
                if kind == RangeSetting.KIND:
                    _print_with_unknown_noise(cases, FALSE_ALARMS / names)


def _print_with_unknown_noise(cases: Sequence[dict[str, Any]], level: float) -> None:
    """Print the same for a test that knows the noise to a factor of two, and for each effect of the noise."""
    powers = [unknown_noise.powers_of_case(case, level) for case in cases]
    print(f"{'':13s} by a test that knows the noise to a factor of two: {np.mean([np.prod(p) for p in powers]):.1%}")
    for name in RangeSetting.IN_NOISE:
        each = [
            power
            for case, several in zip(cases, powers, strict=True)
            for effect, power in zip(case["effects"], several, strict=True)
            if effect["name"] == name
        ]
        if each:
            print(f"{'':13s}   {name:14s} {len(each):4d} effects {np.mean(each):.1%}")
