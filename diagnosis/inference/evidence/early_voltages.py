"""Voltages that change between the rows of a drive, as nuisances of the data.

The log of a controller that is faster than the log does not state when its voltages changed. Two things follow, and
both look like effects of the motors. First, a part of each change acts before it is logged; on average that is half of
the change if the controller is much faster than the log, or if its cycles and the rows meet at random. Secondly, this
part differs from change to change, so that the error of a row is larger where the voltage changes more. The mean part
is fitted with everything else, and its scatter adds to the noise of each row.

Both are only used if the data need them. A log of a controller that runs with the rows has neither.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import EstimatedNoise, Evidence
from diagnosis.inference.evidence.noise_level import with_estimated_noises
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.fitting.likelihood import costs_of_residuals, fitted_noise
from diagnosis.nuisances import Nuisance, Number
from symolo.core.arrays import Array

GRADUAL, AT_ONCE = "voltages_gradual", "voltages_a_row_early"
"""Names of the nuisances: share of the changes that is gradual over the row before, and that comes a row early."""
SHARES = (0.0, 0.02, 0.03, 0.045, 0.065, 0.09, 0.12, 0.16, 0.2, 0.25, 0.3, 0.4, 0.5)
"""Standard deviations of the early part of a change that are tried."""
NEEDED = 15.0
"""Fall of the cost by mean and scatter of the early part from which the data need them."""
ROUNDS = 2
"""Fits after which mean, scatter and correlation of the noise fit each other."""


@dataclass(frozen=True, eq=False)
class EarlyFit:
    """A fit with voltages that act early."""

    evidence: Evidence
    hypothesis: Hypothesis
    fit: HypothesisFit
    fall: float
    """Fall of the cost compared with voltages that are held from row to row."""

    @property
    def is_needed(self) -> bool:
        return self.fall >= NEEDED


@dataclass(frozen=True)
class EarlyPart:
    """Part of a change of the voltage that acts before the row in which the new voltage is logged."""

    mean: float
    """Mean part, between 0 and 1."""
    sd: float
    """Standard deviation between the changes."""


def early_part(evidence: Evidence, fit: HypothesisFit) -> EarlyPart | None:
    """Return the part of the voltages that acts early; None if the voltages act as they are logged."""
    mean = mean_share(fit)
    return EarlyPart(mean, early_share(evidence)) if mean > 0.0 else None


def early_fit(evidence: Evidence, held: HypothesisFit) -> EarlyFit | None:
    """Return a hypothesis again with voltages that act early.

    Args:
        evidence: The observations with the noise of voltages that are held from row to row.
        held: A fit of the hypothesis to them.

    Returns:
        None if nothing follows a voltage, or if no voltage changes.
    """
    nuisances = tuple(_nuisances(evidence, held.robot))
    if not nuisances:
        return None
    before = held.hypothesis.nuisances
    hypothesis = replace(held.hypothesis, nuisances=(*before, *nuisances))
    x = np.insert(held.x, len(before), np.zeros(len(nuisances)))
    (fit,) = fits(evidence, [(hypothesis, x)])
    share, by_scatter = _scatter(evidence, fit)
    fall = held.cost - fit.cost + by_scatter
    for _ in range(ROUNDS if fall >= NEEDED else 0):
        evidence = with_early_share(evidence, share)
        (fit,) = fits(evidence, [(hypothesis, fit.x)])
        evidence = with_estimated_noises(evidence, fit)
        share, _ = _scatter(evidence, fit)
    return EarlyFit(with_early_share(evidence, share), hypothesis, fit, fall)


def with_updated_share(evidence: Evidence, fit: HypothesisFit) -> Evidence:
    """Return the evidence with the scatter of the early part that the residuals of a fit have."""
    if not early_share(evidence):
        return evidence
    return with_early_share(evidence, _scatter(evidence, fit)[0])


def early_share(evidence: Evidence) -> float:
    """Return the standard deviation of the part of a change that acts early, 0 if there is none."""
    return max((noise.early_share for noise in evidence.noises.values()), default=0.0)


def mean_share(fit: HypothesisFit) -> float:
    """Return the mean part of a change that acts early, in the log where it is largest; 0 without such nuisances."""
    # A gradual change acts by half in the row before it, and one at the beginning of this row by the other half.
    means: dict[str, float] = {}
    for nuisance, x in zip(fit.hypothesis.nuisances, fit.x.tolist(), strict=False):
        name, _, case = nuisance.name.partition("[")
        if name in {GRADUAL, AT_ONCE}:
            means[case] = means.get(case, 0.0) + 0.5 * x * nuisance.tolerance
    return min(max(means.values(), default=0.0), 1.0)


def with_early_share(evidence: Evidence, share: float) -> Evidence:
    """Return the evidence with a scatter of the early part of the voltages."""
    noises = dict(evidence.noises)
    for observed in evidence.observed:
        if observed.early is not None:
            before = noises.get(observed.name, EstimatedNoise(1.0, observed.correlation or 0.0))
            noises[observed.name] = replace(before, early_share=share)
    return evidence.with_noises(noises)


def _nuisances(evidence: Evidence, robot: RobotConfig) -> Iterator[Nuisance]:
    """Yield the mean part of the changes that acts early, for the voltages of each log."""
    first = 0
    for stage in evidence.stages:
        quantities = range(first, first + len(stage.observed))
        first += len(stage.observed)
        changes = np.zeros((2, len(evidence.values)))
        for k in quantities:
            early = evidence.observed[k].early
            if early is not None:
                changes[:, evidence.places[k]] = early.changes_of(robot)
        if changes.any():
            case_suffix = evidence.observed[quantities[0]].name.partition("[")[1:]
            for name, change, tolerance in zip((GRADUAL, AT_ONCE), changes, (1.0, 0.5), strict=True):
                title = f"{name}{''.join(case_suffix)}"
                yield Nuisance(title, 0.0, tolerance, "1", _same, tolerance * change, bounds=(0.0, 1.0 / tolerance))


def _scatter(evidence: Evidence, fit: HypothesisFit) -> tuple[float, float]:
    """Return the best standard deviation of the early part, 0 if there is none, and the fall of the cost by it."""
    bare = with_early_share(evidence, 0.0)
    residual = fit.z * fit.sd
    responses = (observed.early.scatter if observed.early else 0.0 * observed.sd for observed in bare.observed)
    sizes = np.concatenate(list(responses))
    is_level_fixed = np.zeros(len(bare.observed), dtype=bool)
    costs: list[float] = []
    mean = mean_share(fit)
    # Of all parts between 0 and 1 with this mean, those that are either 0 or 1 scatter most.
    for share in [each for each in SHARES if each <= np.sqrt(mean * (1.0 - mean))]:
        sd = np.hypot(bare.sd, share * sizes)
        noise = fitted_noise(bare, residual / sd, sd, fit.noise, is_level_fixed)
        level: Array = noise.levels[bare.quantity]
        each = costs_of_residuals(bare, residual / (sd * level), sd * level, noise)
        costs.append(float(each[bare.fit].sum()) + noise.prior_cost)
    best = int(np.argmin(costs))
    return SHARES[best], costs[0] - costs[best]


def _same(robot: RobotConfig, value: Number) -> RobotConfig:
    """Return the robot itself, of which the timing of the voltages is no part."""
    del value
    return robot
