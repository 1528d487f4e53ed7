"""The effects that stay named where a structure remains unexplained.

An effect stays named only if it is needed in addition to the flexible functions that describe the structure: an effect
that was only a substitute for the unknown cause becomes insignificant beside them.
"""

from collections.abc import Iterable, Mapping

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.projection import orthonormal
from diagnosis.inference.selection.removal import without
from diagnosis.inference.unexplained.adequacy import LEVEL, Adequacy, Structure, change_by
from diagnosis.inference.unexplained.bases import any_function
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

NEEDED = 16.0
"""Fall of the cost beside the flexible functions, four standard errors, by which an effect stays named. It must not be
less than what the functions explain, else the effect may be a part of the unknown cause."""
EXPLAINED = 0.9
"""Share of the explainable cost that the effects must explain to stay named."""
MIN_PART = 0.05
"""Part of the change by an effect in one stage, from which a structure of that stage speaks about the effect."""


def retained_effects(
    evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, result: Adequacy
) -> list[CandidateEffect]:
    """Return the effects of a fit that are needed in addition to what is unexplained, the most needed first.

    Each stage is predicted from what was measured at its input, so an unknown cause in one stage has no substitute in
    another. An effect must therefore be needed in every stage that it changes and that has an unexplained structure.

    Args:
        evidence: The observations.
        nominal: The fit without effects.
        fit: The fit with the effects.
        result: Test of the residuals of the fit.
    """
    changes = {effect: change_by(evidence, nominal, fit, effect) for effect in fit.hypothesis.effects}
    root = fit.root_weights()
    staying = list(changes)
    for stage, structure in _worst_by_stage(evidence, result).items():
        rows = evidence.stage_index == stage
        squares = {effect: ((root * change) ** 2) for effect, change in changes.items()}
        contested = {
            effect: changes[effect]
            for effect in staying
            # An effect of the noise changes no mean, and may be a substitute in any stage.
            if float(squares[effect][rows].sum()) >= MIN_PART * float(squares[effect].sum())
        }
        if structure.is_of_outliers:
            needed = _needed_without(evidence, fit, structure, contested)
        else:
            needed = _needed_beside(nominal, fit, structure, contested, rows)
        order = [*needed, *(effect for effect in staying if effect not in contested)]
        staying = [effect for effect in order if effect in needed or effect not in contested]
    return staying


def _worst_by_stage(evidence: Evidence, result: Adequacy) -> dict[int, Structure]:
    """Return the worst structure of each stage that has a significant one, that of the whole test first."""
    stages = [number for number, stage in enumerate(evidence.stages) for _ in stage.observed]
    stage_of = {observed.name: stage for observed, stage in zip(evidence.observed, stages, strict=True)}
    order = [stage_of[result.worst.observed], *stages]
    worst: dict[int, Structure] = {}
    for stage in dict.fromkeys(order):
        stage_structures = [s for s in result.structures if s.p < LEVEL and stage_of[s.observed] == stage]
        with_cause = [s for s in stage_structures if not s.may_lack_cause]
        if stage_structures:
            worst[stage] = Adequacy(tuple(with_cause or stage_structures)).worst
    return worst


def _needed_without(
    evidence: Evidence, fit: HypothesisFit, outliers: Structure, contested: Iterable[CandidateEffect]
) -> list[CandidateEffect]:
    """Return which effects are needed in the rows that do not stand out, since effects act in all rows.

    The models with and without each effect are fitted to these rows: an effect that a nominal number imitates is known
    by the tolerances alone, and a linear analysis says little about a number that is many tolerances off.
    """
    rest = evidence.with_rows(fit=evidence.fit & ~outliers.basis.any(axis=1))
    effects = list(contested)
    (whole, *fewer) = fits(
        rest, [(each.hypothesis, each.x) for each in (fit, *(without(evidence, fit, e) for e in effects))]
    )
    rises = {effect: base.cost - whole.cost for effect, base in zip(effects, fewer, strict=True)}
    return [effect for effect in sorted(effects, key=lambda e: -rises[e]) if rises[effect] >= NEEDED]


def _needed_beside(
    nominal: HypothesisFit,
    fit: HypothesisFit,
    structure: Structure,
    contested: Mapping[CandidateEffect, Array],
    rows: Mask,
) -> list[CandidateEffect]:
    """Return which effects are needed in addition to a structure, the most needed first.

    The residuals of the nominal model are explained again, linearly and with the weights of the fit: first by the
    flexible functions, then by one effect after the other, each at its fitted size, as long as one is needed. An effect
    of the noise does not change the mean, and is given up with the first structure of the mean.

    Args:
        nominal: The fit without effects.
        fit: The fit with the effects.
        structure: Structure in the residuals of the fit.
        contested: Change (N,) of the nominal prediction by each effect, in sigmas.
        rows: (N,), samples of the stage that has the structure.
    """
    root = fit.root_weights()
    flexible: list[Array] = []
    min_fall = NEEDED
    if not structure.is_drift:
        # Effects that explain much less than what stays unexplained are probably parts of the unknown cause.
        drop = _fall_of_stage(nominal, fit, rows)
        if drop < EXPLAINED * (drop + structure.explainable):
            return []
        min_fall = max(NEEDED, structure.explainable)
        # A drift is slow: any function of time could also imitate what a sweep does from row to row.
        flexible = [_functions(nominal.evidence, structure)]
    size = nominal.hypothesis.size
    functions = np.concatenate([structure.basis, *flexible], axis=1)
    taken_functions = np.concatenate([functions * root[:, None], np.zeros((size, functions.shape[1]))])
    taken = [nominal.tangents(root), taken_functions]
    residual = nominal.weighted_residuals(nominal.z, root)
    needed: list[CandidateEffect] = []
    priors = np.zeros(size)
    changes = {effect: np.concatenate([root * change, priors]) for effect, change in contested.items()}
    while changes:
        basis = orthonormal(np.concatenate(taken, axis=1))
        falls = {effect: _fall(residual, change, basis) for effect, change in changes.items()}
        best = max(falls, key=lambda effect: falls[effect])
        if falls[best] < min_fall:
            break
        needed.append(best)
        taken.append(changes.pop(best)[:, None])
    return needed


def _fall_of_stage(nominal: HypothesisFit, fit: HypothesisFit, rows: Mask) -> float:
    """Return the fall of the cost by the effects of a fit over the samples of one stage, and of the priors."""
    falls = (nominal.costs - fit.costs)[rows & nominal.evidence.fit]
    return float(falls.sum()) + nominal.prior_cost - fit.prior_cost


def _functions(evidence: Evidence, structure: Structure) -> Array:
    """Return columns (N, k) for any function of the structure's covariate, and of the one that it acts with.

    They exist for every quantity with these covariates, since a cause shows in several quantities.
    """
    parts = []
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        beside = {covariate.beside for covariate in quantity.covariates if covariate.name == structure.covariate}
        for covariate in quantity.covariates:
            if covariate.name in {structure.covariate, *beside}:
                functions = any_function(covariate, evidence.fit[place])
                columns = np.zeros((len(evidence.values), functions.shape[1]))
                columns[place] = functions
                parts.append(columns)
    return np.concatenate(parts, axis=1)


def _fall(residual: Array, change: Array, basis: Array) -> float:
    """Return the fall of the squares by the best multiple of a change, in addition to a basis."""
    free = change - basis @ (basis.T @ change)
    square = float(free @ free)
    return float(free @ residual) ** 2 / square if square > 1e-9 * float(change @ change) else 0.0
