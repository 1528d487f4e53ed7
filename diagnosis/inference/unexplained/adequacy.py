"""Is the best named model adequate, or does structure remain that no name accounts for?

A flexible competitor decides: for each observed quantity and each covariate, functions of the covariate are held
against what the model leaves (score test; Godfrey, Misspecification Tests in Econometrics, 1988). Residuals are
clipped, and both they and the functions are projected against all that is fitted, priors included, so that a misfit
which a parameter could still take is none. The share of the residual in the functions' span, over what remains outside,
has the F distribution where the model is adequate, whatever the level of the noise; p-values are combined by Bonferroni
over all tests.

Where structure remains, a name is kept only if it is needed beside the flexible functions: an effect that merely stood
in for the unknown cause loses its significance when they take its place.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit
from diagnosis.inference.hypothesis import CandidateEffect, moved
from diagnosis.inference.likelihood import robust_weight
from diagnosis.inference.projection import beyond, orthonormal
from diagnosis.inference.unexplained.bases import RUNS_OF_ROWS, Basis, any_function, bases, standing_out
from diagnosis.predictors.base import ROW_TIME
from symolo.core.arrays import Array

LEVEL = 0.001
"""Probability, over all tests together, of calling an adequate model inadequate."""
REWEIGHTED = 6
"""Times that rows are weighed anew."""
CLIP = 3.0
"""Sigmas at which residuals are clipped."""
NEEDED = 16.0
"""Fall of the cost beside the flexible functions, four standard errors, by which a name is kept; and no less than what
they explain beyond it, else the name may be another face of the unknown."""
AS_MUCH = 0.8
"""Share of what another covariate explains, from which two tell the same."""
MATERIAL = 9.0
"""Fall of the cost below which nothing is structure, however sure it is. Where readings scatter as they are said to,
chance alone allows as much; it matters where they scatter far less, as in a log that was simulated, in which a stage's
own way of integrating would show."""
EXPLAINED = 0.8
"""Share of what can be explained at all that names must explain to be kept."""


@dataclass(frozen=True)
class Structure:
    """What remains in one observed quantity along one covariate."""

    observed: str
    channel: str
    covariate: str
    what: str
    p: float
    """Of all tests, after Bonferroni; at most 1."""
    explainable: float
    """Fall of the cost that the flexible functions would bring beyond chance."""
    rank: int
    """Of the covariate in its quantity's list."""
    basis: Array
    """(N, k), the functions over all samples, 0 outside the quantity and the rows of the fit."""


@dataclass(frozen=True)
class Adequacy:
    structures: tuple[Structure, ...]
    """The best of each quantity and covariate, the most significant first; rows that stand out together, apart."""

    @property
    def is_adequate(self) -> bool:
        return not self.structures or self.structures[0].p >= LEVEL

    @property
    def worst(self) -> Structure:
        """The most significant; of covariates that tell the same of a quantity, the first as the stage lists them."""
        top = self.structures[0]
        same = [s for s in self.structures if s.observed == top.observed and s.p < LEVEL]
        alike = [s for s in same if s.explainable >= AS_MUCH * top.explainable]
        return min(alike, key=lambda s: s.rank) if self.structures[0].p < LEVEL else top


def adequacy(evidence: Evidence, fit: Fit, beside: Array | None = None) -> Adequacy:
    """What is left of a fit, or of it with free multiples of columns (N, k) in its sigmas beside it."""
    tangents = _Tangents(evidence, fit, np.zeros((len(fit.z), 0)) if beside is None else beside)
    found: list[Structure] = []
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        rows = evidence.fit[place]
        if np.count_nonzero(rows) < 8:
            continue
        inside = np.arange(place.start, place.stop)[rows]
        along = [(rank, of, bases(of, rows)) for rank, of in enumerate(quantity.covariates)]
        along += [
            (rank, of, standing_out(tangents.left[inside], quantity.trial[rows]))
            for rank, of, _ in along
            if of.name == ROW_TIME
        ]
        for rank, covariate, functions in along:
            best: Structure | None = None
            for basis in functions:
                p, gain = tangents.test(inside, basis)
                p = min(1.0, p * basis.tries) if gain >= MATERIAL else 1.0
                if best is None or p < best.p:
                    names = (quantity.name, quantity.channel, covariate.name)
                    columns = np.zeros((len(evidence.values), basis.columns.shape[1]))
                    columns[inside] = basis.columns
                    best = Structure(*names, basis.what, p, gain, rank, columns)
            if best is not None:
                found.append(best)
    whole = [replace(structure, p=min(1.0, structure.p * len(found))) for structure in found]
    told = {s.observed for s in whole if s.p < LEVEL and s.what != RUNS_OF_ROWS}
    # What is a function of something also makes runs of rows stand out, which then tell nothing more.
    left = [s for s in whole if s.what != RUNS_OF_ROWS or s.observed not in told]
    return Adequacy(tuple(sorted(left, key=lambda s: (s.p, -s.explainable))))


class _Tangents:
    """Directions of all that is fitted, with rows for the priors."""

    def __init__(self, evidence: Evidence, fit: Fit, beside: Array) -> None:
        self._evidence = evidence
        self._root = np.where(evidence.fit, np.sqrt(evidence.weight), 0.0)
        z, x = _moved_beside(evidence, fit, beside)
        padded = np.concatenate([beside * self._root[:, None], np.zeros((len(fit.x), beside.shape[1]))])
        self._basis = orthonormal(np.concatenate([fit.tangents(self._root), padded], axis=1))
        left = replace(fit, x=x).left(np.clip(z, -CLIP, CLIP), self._root)
        self.left = left - self._basis @ (self._basis.T @ left)
        """(N + P,), clipped residuals less all that the model could still take, in sigmas and weighed."""

    def test(self, inside: NDArray[np.intp], basis: Basis) -> tuple[float, float]:
        """p-value of a basis over the samples `inside`, and fall of the cost beyond chance."""
        columns = basis.columns * self._root[inside, None]
        taken = self._basis[inside].T @ columns
        combined = beyond(columns, taken)
        k = combined.shape[1]
        if k == 0:
            return 1.0, 0.0
        left = self.left[inside]
        along = combined.T @ (columns.T @ left)
        explained = float(along @ along)
        here = left - columns @ (combined @ along) + self._basis[inside] @ (taken @ (combined @ along))
        weight = float(self._evidence.weight[inside[0]])
        degrees = max(1, len(inside) - k - 1)
        level = float(here @ here) / weight / degrees
        p = float(fdtrc(k, degrees, explained / k / max(level, 1e-12)))
        return p, max(0.0, explained - k * level)


def _moved_beside(evidence: Evidence, fit: Fit, columns: Array) -> tuple[Array, Array]:
    """Residuals (N,) and coordinates (P,) of a fit beside columns (N, k), both moved to where they explain best.

    Reweighted for outliers.
    """
    z, x = fit.z, fit.x
    for _ in range(REWEIGHTED if columns.shape[1] else 0):
        root = np.where(evidence.fit, np.sqrt(evidence.weight * robust_weight(z)), 0.0)
        padded = np.concatenate([columns * root[:, None], np.zeros((len(fit.x), columns.shape[1]))])
        both = np.concatenate([padded, fit.tangents(root)], axis=1)
        solved = np.linalg.lstsq(both, fit.left(fit.z, root), rcond=1e-10)[0]
        z = fit.z - np.concatenate([columns, fit.slopes.T], axis=1) @ solved
        x = fit.x + solved[columns.shape[1] :]
    return z, x


def survivors(evidence: Evidence, nominal: Fit, fit: Fit, structure: Structure) -> list[CandidateEffect]:
    """The effects of a fit that are needed beside a structure that they do not explain, the most needed first.

    What the nominal model leaves is explained anew, linearly and with the weights of the fit: first by the flexible
    functions, then by one effect after the other, each at its fitted size, as long as one is needed. An effect of the
    noise is none of the mean, and falls with the first structure of it.

    Args:
        evidence: What was observed.
        nominal: Without effects.
        fit: With the effects.
        structure: What remains of the fit.
    """
    drop = nominal.cost - fit.cost
    if drop < EXPLAINED * (drop + structure.explainable):
        return []
    root = np.where(evidence.fit, np.sqrt(evidence.weight * robust_weight(fit.z)), 0.0)
    size = nominal.hypothesis.size
    functions = np.concatenate([structure.basis, _functions(evidence, structure)], axis=1)
    flexible = np.concatenate([functions * root[:, None], np.zeros((size, functions.shape[1]))])
    taken = [nominal.tangents(root), flexible]
    residual = nominal.left(nominal.z, root)
    kept: list[CandidateEffect] = []
    priors = np.zeros(size)
    left = {
        effect: np.concatenate([root * change_by(evidence, nominal, fit, effect), priors])
        for effect in fit.hypothesis.effects
    }
    while left:
        basis = orthonormal(np.concatenate(taken, axis=1))
        falls = {effect: _fall(residual, change, basis) for effect, change in left.items()}
        best = max(falls, key=lambda effect: falls[effect])
        if falls[best] < max(NEEDED, structure.explainable):
            break
        kept.append(best)
        taken.append(left.pop(best)[:, None])
    return kept


def _functions(evidence: Evidence, structure: Structure) -> Array:
    """Any function of the structure's covariate, and of the one that it acts with, in every quantity that has them,
    for a cause shows in several; (N, k).
    """
    found = []
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        beside = {covariate.beside for covariate in quantity.covariates if covariate.name == structure.covariate}
        for covariate in quantity.covariates:
            if covariate.name in {structure.covariate, *beside}:
                of = any_function(covariate, evidence.fit[place])
                columns = np.zeros((len(evidence.values), of.shape[1]))
                columns[place] = of
                found.append(columns)
    return np.concatenate(found, axis=1)


def change_by(evidence: Evidence, nominal: Fit, fit: Fit, effect: CandidateEffect) -> Array:
    """Of the nominal prediction by one effect at its fitted size, in nominal sigmas (N,); 0 where nothing is fitted."""
    alone = nominal.hypothesis.with_effect(effect)
    x = moved(nominal.x, nominal.hypothesis, alone)
    x[alone.parameters(effect)] = fit.x[fit.hypothesis.parameters(effect)]
    found = evidence.of([nominal.hypothesis.robot(nominal.x), alone.robot(x)]).mean
    return np.where(evidence.fit, (found[1] - found[0]) / nominal.sd, 0.0)


def _fall(residual: Array, change: Array, basis: Array) -> float:
    """Of the squares, by the best multiple of a change, beside all that is in a basis."""
    free = change - basis @ (basis.T @ change)
    square = float(free @ free)
    return float(free @ residual) ** 2 / square if square > 1e-9 * float(change @ change) else 0.0
