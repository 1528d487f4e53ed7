"""What an ideal test of a range bench could see if it knows the noise no better than a diagnosis does.

The stated noise may be wrong by a factor of two, and neighbours may have a correlation of up to 0.2. An effect of the
mean is then seen by an F test, which learns the noise from the rows. An effect of the noise is seen by the most
powerful test of its true size against that noise without it from which it is hardest to distinguish (Lehmann and
Romano, Testing Statistical Hypotheses, 3rd ed., section 3.8). Outliers are left out, so that no diagnosis sees more.
"""

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from scipy.stats import f, ncf

from benchmarks.diagnosis.independent_cases.case import draw_case
from benchmarks.diagnosis.independent_cases.ranges.tof_bench import RangeSetting
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, variant_of

LEVELS = (0.25, 0.5, 1.0, 2.0, 3.0, 4.0)
"""Variances of the noise that are tried, relative to the stated one."""
CORRELATIONS = (0.0, 0.2)
"""Correlations of neighbouring rows that are tried."""
NOMINAL_NUMBERS = 2
"""Number of nominal parameters: offset and scale."""
DRAWS = 20_000
"""Draws from which the quantiles of a test are estimated."""


def power_of_f_test(ratio: float, numbers: int, rows: int, level: float) -> float:
    """Return the power for an effect with so many numbers, whose likelihood ratio was computed with the true noise."""
    degrees = max(rows - numbers - NOMINAL_NUMBERS, 1)
    return float(ncf.sf(f.isf(level, numbers, degrees), numbers, degrees, ratio))


def power_of_noise_test(without: Array, true: Array, level: float) -> float:
    """Return the power of the most powerful test of a Gaussian with one covariance (n, n) against another one."""
    lower = np.linalg.inv(np.linalg.cholesky(without))
    ratios = np.maximum(np.linalg.eigvalsh(lower @ true @ lower.T), 1e-9)
    squares = np.random.default_rng(1).standard_normal((DRAWS, len(ratios))) ** 2
    weights = 1.0 - 1.0 / ratios
    return float(np.mean(squares @ (weights * ratios) > np.quantile(squares @ weights, 1.0 - level)))


def powers_of_case(truth: dict[str, Any], level: float) -> list[float]:
    """Return the power of the test for each effect of a case of truth.json."""
    effects = truth["effects"]
    rows = truth["setting"]["rows_fit"]
    numbers = [sum(isinstance(value, float) for value in effect["parameters"].values()) or 1 for effect in effects]
    powers = [power_of_f_test(e["lr"], count, rows, level) for e, count in zip(effects, numbers, strict=True)]
    if not any(effect["name"] in RangeSetting.IN_NOISE for effect in effects):
        return powers
    names = [effect["name"] for effect in effects]
    drawn, _ = draw_case(RangeSetting, truth["category"], names, np.random.default_rng(truth["seed"]))
    listed = variant_of(drawn.sized).effects
    for place, effect in enumerate(listed):
        if effect.name in RangeSetting.IN_NOISE:
            others = [other for other in listed if other is not effect]
            powers[place] = _seen_in_noise(cast("RangeSetting", drawn.setting), effect, others, level)
    return powers


def _seen_in_noise(setting: RangeSetting, effect: Effect, others: Sequence[Effect], level: float) -> float:
    """Return the power for an effect of the noise beside others."""
    true = setting.noise_covariance([*others, effect])
    return min(
        power_of_noise_test(setting.noise_covariance(others, variance, correlation), true, level)
        for variance in LEVELS
        for correlation in CORRELATIONS
    )
