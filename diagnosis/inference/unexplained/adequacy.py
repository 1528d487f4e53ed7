"""Test whether the best model is adequate, or whether structure remains in its residuals.

For each observed quantity and each covariate, flexible functions of the covariate are tested against the residuals
(score test; Godfrey, Misspecification Tests in Econometrics, 1988). The residuals are clipped, and both they and the
functions are projected onto what the fitted parameters, with their priors, cannot explain, so that a misfit that a
parameter could still remove does not count. The share of the residuals inside the span of the functions, relative to
the share outside, has the F distribution if the model is adequate, whatever the level of the noise. The p-values of all
tests are combined by Bonferroni.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect, moved
from diagnosis.inference.fitting.projection import beyond, orthonormal
from diagnosis.inference.unexplained.bases import (
    OUTLIERS_IN_A_ROW,
    RUNS_OF_OUTLIERS,
    RUNS_OF_ROWS,
    Basis,
    bases,
    standing_out,
)
from diagnosis.inference.unexplained.outlier_clusters import APART, beginnings, cluster, wild
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import ROW_TIME, Covariate
from symolo.core.arrays import Array

LEVEL = 0.001
"""Probability, over all tests together, of calling an adequate model inadequate."""
MIN_ROWS = 8
"""Smallest number of rows of a quantity that is tested."""
CLUSTER = "outliers at neighbouring values"
REWEIGHTINGS = 6
"""Iterations of the weights for outliers."""
CLIP = 3.0
"""Residual in sigmas at which it is clipped."""
AS_MUCH = 0.8
"""Share of what another covariate explains, from which two covariates count as equal."""
MATERIAL = 9.0
"""Smallest fall of the cost for a structure, by the stated noise, however significant it is. If readings scatter as
stated, chance alone reaches as much. It matters if they scatter far less, as in a simulated log, where integration
errors would show."""
DRIFT = 1.0
"""Root mean square in sigmas up to which the zero of an instrument may drift, within a session and from one to the
next. It is reported as unexplained, but does not speak against effects that do not depend on time."""
MAX_RUNS = 2
"""Number of runs of outliers that may lie near each other in time by chance. A run is one event in the logger, and not
as many as it has outliers."""
SESSION = ("row", "session_time_s", "sweep", "trial")
"""Covariates that tell when a row was taken; `t_s` too, where a quantity has no time since the session began."""


@dataclass(frozen=True)
class Structure:
    """Structure in the residuals of one observed quantity along one covariate."""

    observed: str
    channel: str
    covariate: str
    what: str
    p: float
    """p-value over all tests, after Bonferroni; at most 1."""
    explainable: float
    """Fall of the cost by the flexible functions beyond chance."""
    rank: int
    """Index of the covariate in the list of its quantity."""
    basis: Array
    """(N, k), the functions over all samples; 0 outside the quantity and the rows of the fit."""
    size: float
    """Root mean square of the structure [sigma], over the rows of the fit of its quantity."""
    is_over_time: bool
    """Whether the covariate is only the time at which a row was taken. A jump of speeds from counts is no such
    structure, because counts have no zero that may drift."""
    is_of_outliers: bool = False
    """Whether the structure may be a few outliers in successive rows, which a logger can cause."""

    @property
    def is_drift(self) -> bool:
        """Return whether the structure may be the slow drift that every zero has, and need not have a cause."""
        return self.is_over_time and self.size < DRIFT

    @property
    def may_lack_cause(self) -> bool:
        """Return whether the structure may be a disturbance of the log, which says nothing about the robot."""
        return self.is_drift or self.is_of_outliers


@dataclass(frozen=True)
class Adequacy:
    """Result of the test."""

    structures: tuple[Structure, ...]
    """Best structure of each quantity and covariate, and of runs of rows, the most significant first."""

    @property
    def is_adequate(self) -> bool:
        return not self.structures or self.structures[0].p >= LEVEL

    @property
    def leaves_only_outliers(self) -> bool:
        """Return whether the model is adequate but for outliers in successive rows, which favour no effect."""
        return all(s.is_of_outliers for s in self.structures if s.p < LEVEL)

    @property
    def has_cause(self) -> bool:
        """Return whether there is a significant structure that is no mere disturbance of the log."""
        return any(s.p < LEVEL and not s.may_lack_cause for s in self.structures)

    def of(self, observed: str) -> "Adequacy":
        """Return the same with the structures of one observed quantity only."""
        return Adequacy(tuple(structure for structure in self.structures if structure.observed == observed))

    @property
    def worst(self) -> Structure:
        """The most significant structure; of covariates that explain a quantity equally well, the first."""
        significant = [s for s in self.structures if s.p < LEVEL]
        # Beside a lasting structure, outliers in a row say nothing.
        top = next((s for s in significant if not s.is_of_outliers), self.structures[0])
        same = [s for s in significant if s.observed == top.observed and s.is_of_outliers == top.is_of_outliers]
        alike = [s for s in same if s.explainable >= AS_MUCH * top.explainable]
        return min(alike, key=lambda s: s.rank) if significant else top


def adequacy(evidence: Evidence, fit: HypothesisFit, beside: Array | None = None) -> Adequacy:
    """Test the residuals of a fit; `beside` are columns (N, k) in sigmas whose multiples are fitted in addition."""
    tangents = _Tangents(evidence, fit, np.zeros((len(fit.z), 0)) if beside is None else beside)
    structures: list[Structure] = []
    for number, rows in enumerate(evidence.fit[place] for place in evidence.places):
        if np.count_nonzero(rows) >= MIN_ROWS:
            structures += _functions_of(evidence, fit, tangents, number)
            structures += _clusters(evidence, tangents, number)
    # Bonferroni: with so many tests, one of them would reject an adequate model by chance.
    whole = [replace(structure, p=min(1.0, structure.p * len(structures))) for structure in structures]
    row_forms = (RUNS_OF_ROWS, RUNS_OF_OUTLIERS, CLUSTER)
    explained = {s.observed for s in whole if s.p < LEVEL and s.what not in row_forms}
    # A function of a covariate also makes single rows stand out, which then add nothing.
    structures = [s for s in whole if s.what not in row_forms or s.observed not in explained]
    return Adequacy(tuple(sorted(structures, key=lambda s: (s.p, -s.explainable))))


def _functions_of(evidence: Evidence, fit: HypothesisFit, tangents: "_Tangents", number: int) -> Iterator[Structure]:
    """Yield the best function of each covariate of a quantity, and the runs of its rows that stand out most."""
    quantity, place, level = evidence.observed[number], evidence.places[number], float(fit.noise.levels[number])
    rows = evidence.fit[place]
    inside = np.arange(place.start, place.stop)[rows]
    wild_rows = wild(tangents.z[inside], quantity.trial[rows])
    runs = beginnings(wild_rows) if quantity.is_series else np.arange(len(inside))
    session = any(covariate.name == "session_time_s" for covariate in quantity.covariates)
    along = [(rank, covariate, bases(covariate, rows)) for rank, covariate in enumerate(quantity.covariates)]
    along += [
        (rank, covariate, standing_out(tangents.residuals[inside], quantity.trial[rows], wild_rows, what))
        for rank, covariate, _ in along
        for what in (RUNS_OF_ROWS, RUNS_OF_OUTLIERS)
        # What a voltage did before it was logged lasts for some rows, so that a run of rows is no sign of a cause.
        if covariate.name == ROW_TIME and not evidence.has_early_voltages(quantity)
    ]
    rows_worth = float(evidence.weight[inside].sum())
    for rank, covariate, functions in along:
        best: Structure | None = None
        for basis in functions:
            p, gain = tangents.test(number, inside, basis, runs)
            p = min(1.0, p * basis.tries) if gain * level**2 >= MATERIAL else 1.0
            if best is None or p < best.p:
                columns = np.zeros((len(evidence.values), basis.columns.shape[1]))
                columns[inside] = basis.columns
                best = Structure(
                    observed=quantity.name,
                    channel=quantity.channel,
                    covariate=covariate.name,
                    what=basis.what,
                    p=p,
                    explainable=gain,
                    rank=rank,
                    basis=columns,
                    size=float(np.sqrt(gain / rows_worth)),
                    is_over_time=basis.what not in {RUNS_OF_ROWS, RUNS_OF_OUTLIERS}
                    and (covariate.name in SESSION or (covariate.name == ROW_TIME and not session)),
                    is_of_outliers=basis.is_of_outliers,
                )
        if best is not None:
            yield best


def _clusters(evidence: Evidence, tangents: "_Tangents", number: int) -> Iterator[Structure]:
    """Yield the outliers of a quantity that gather along each covariate, where there are any."""
    quantity, place = evidence.observed[number], evidence.places[number]
    # Outliers are readings. What a motor does for a row lasts longer in its speed, unlike an error of the logger.
    rows, whitening = evidence.fit[place], evidence.whitenings[number]
    z = evidence.unwhitened(number, tangents.z[place])
    # A speed may scatter more than stated, by a larger torque, whose errors neighbours have in common.
    z = z if whitening is None else z / max(whitening.level, 1.0)
    for rank, covariate in enumerate(quantity.covariates):
        clustered = cluster(z, covariate, rows, quantity.trial if quantity.is_series else None)
        if clustered is None:
            continue
        column = np.zeros((len(evidence.values), 1))
        column[place, 0] = np.where(clustered.rows, np.sign(z), 0.0)
        squares = CLIP**2 * float(evidence.weight[place][clustered.rows].sum())
        yield Structure(
            observed=quantity.name,
            channel=quantity.channel,
            covariate=covariate.name,
            what=CLUSTER,
            p=clustered.p,
            explainable=squares,
            rank=rank,
            basis=column,
            size=float(np.sqrt(squares / evidence.weight[place][rows].sum())),
            is_over_time=False,
            is_of_outliers=may_be_of_logger(clustered.rows, MAX_RUNS if is_clock(covariate) else 1),
        )


def is_clock(covariate: Covariate) -> bool:
    """Return whether a covariate tells only when a row was taken."""
    return covariate.name in SESSION or covariate.name == ROW_TIME


def may_be_of_logger(rows: Mask, max_runs: int = 1) -> bool:
    """Return whether a logger can cause runs of some rows.

    Args:
        rows: (n,), rows that stand out.
        max_runs: Number of runs in which a logger can cause them.
    """
    places = np.flatnonzero(rows)
    runs = [places] if max_runs == 1 else np.split(places, 1 + np.flatnonzero(np.diff(places) > APART))
    return len(runs) <= max_runs and max(int(run[-1] - run[0]) + 1 for run in runs) <= OUTLIERS_IN_A_ROW


class _Tangents:
    """Directions of all fitted parameters, with rows for the priors."""

    def __init__(self, evidence: Evidence, fit: HypothesisFit, beside: Array) -> None:
        self._evidence = evidence
        self._root = np.where(evidence.fit, np.sqrt(evidence.weight), 0.0)
        z, x = _moved_beside(fit, beside)
        self.z = z
        """(N,), residuals in sigmas, which are not clipped."""
        padded = np.concatenate([beside * self._root[:, None], np.zeros((len(fit.x), beside.shape[1]))])
        self._basis = orthonormal(np.concatenate([fit.tangents(self._root), padded], axis=1))
        self._rows: dict[int, tuple[NDArray[np.intp], Array]] = {}
        """Samples of a quantity that were tested last, and the rows of `_basis` at them, by number of the quantity."""
        residuals = replace(fit, x=x).weighted_residuals(np.clip(z, -CLIP, CLIP), self._root)
        self.residuals = residuals - self._basis @ (self._basis.T @ residuals)
        """(N + P,), weighted clipped residuals in sigmas without all that the parameters could still explain."""

    def test(self, number: int, inside: NDArray[np.intp], basis: Basis, runs: NDArray[np.intp]) -> tuple[float, float]:
        """Return the p-value of a basis over samples `inside` of a quantity, and the fall of the cost beyond chance.

        `runs` are the places among them at which a row begins, or a run of outliers that are one mistake of the logger.
        """
        columns, tangents = basis.columns * self._root[inside, None], self._tangents_at(number, inside)
        taken = tangents.T @ columns
        combined = beyond(columns, taken)
        k = combined.shape[1]
        if k == 0:
            return 1.0, 0.0
        residuals = self.residuals[inside]
        along = combined.T @ (columns.T @ residuals)
        free = columns @ combined - tangents @ (taken @ combined)
        outside = residuals - free @ along
        explained = float(along @ along) / self._more_noise(number, inside, free)
        # Inside the span of a smooth function, correlated noise has (1 + p)/(1 - p) times the squares of independent
        # noise. The weight in `explained` corrects that. The level is that of single rows, without the weight.
        weight = float(self._evidence.weight[inside[0]])
        degrees = max(1, len(inside) - k - 1)
        level = float(outside @ outside) / weight / degrees
        gain = max(0.0, explained - k * level)
        if basis.what != RUNS_OF_OUTLIERS:
            explained /= _more_squares(free * outside[:, None], runs)
        return f_test(explained, level, k, degrees), gain

    def _tangents_at(self, number: int, inside: NDArray[np.intp]) -> Array:
        """Return the rows of the basis of all parameters at samples of a quantity, of which thousands are tested."""
        if self._rows.get(number, (None,))[0] is not inside:
            self._rows[number] = inside, self._basis[inside]
        return self._rows[number][1]

    def _more_noise(self, number: int, inside: NDArray[np.intp], functions: Array) -> float:
        """Return the squares of the noise inside the span of functions, relative to independent noise; at least 1.

        Two samples with a reading of opposite signs add up along a wave of which they are half a cycle apart.

        Args:
            number: Number of the quantity.
            inside: Its samples in the fit.
            functions: (n, k), orthonormal functions over these samples.
        """
        quantity, first = self._evidence.observed[number], self._evidence.places[number].start
        if quantity.shared is None:
            return 1.0
        whole = np.zeros((len(quantity.values), functions.shape[1]))
        whole[inside - first] = functions
        later = quantity.shared.later
        together = quantity.trial[later:] == quantity.trial[:-later]
        products = (whole[:-later] * whole[later:]).sum(axis=1) * together
        shared = float(products @ quantity.shared.correlation[:-later])
        return max(1.0, 1.0 + 2.0 * shared / functions.shape[1])


def _more_squares(products: Array, runs: NDArray[np.intp]) -> float:
    """Return by which factor runs of outliers scatter more along functions than independent rows; at least 1.

    The errors within a run add up, and runs are independent (Liang and Zeger, Biometrika 73 (1986) 13-22).

    Args:
        products: (n, k), functions times residuals.
        runs: Places at which a row or a run begins.
    """
    return max(1.0, float((np.add.reduceat(products, runs) ** 2).sum()) / max(float((products**2).sum()), 1e-300))


def f_test(explained: float, level: float, functions: int, degrees: float) -> float:
    """Return the probability that chance explains as much as some functions do, by the F distribution.

    Args:
        explained: Squares inside the span of the functions, each weighted by the independent samples it is worth.
        level: Mean square outside the span, which estimates the variance of the noise, whatever it is.
        functions: Number of independent functions.
        degrees: Degrees of freedom of `level`.
    """
    return float(fdtrc(functions, degrees, explained / functions / max(level, 1e-12)))


def _moved_beside(fit: HypothesisFit, columns: Array) -> tuple[Array, Array]:
    """Return residuals (N,) and coordinates (P,) of a fit after a joint linear fit of columns (N, k) and coordinates.

    Outliers are reweighted.
    """
    z, x = fit.z, fit.x
    # With the columns, samples that were outliers may fit, and others may become outliers.
    for _ in range(REWEIGHTINGS if columns.shape[1] else 0):
        root = fit.root_weights(z)
        padded = np.concatenate([columns * root[:, None], np.zeros((len(fit.x), columns.shape[1]))])
        both = np.concatenate([padded, fit.tangents(root)], axis=1)
        solved = np.linalg.lstsq(both, fit.weighted_residuals(fit.z, root), rcond=1e-10)[0]
        z = fit.z - np.concatenate([columns, fit.slopes.T], axis=1) @ solved
        x = fit.x + solved[columns.shape[1] :]
    return z, x


def change_by(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect) -> Array:
    """Return the change (N,) of the nominal prediction by a fitted effect alone, in sigmas; 0 outside the fit."""
    alone = nominal.hypothesis.with_effect(effect)
    x = moved(nominal.x, nominal.hypothesis, alone)
    x[alone.parameters(effect)] = fit.x[fit.hypothesis.parameters(effect)]
    before, after = evidence.predicted([nominal.robot, alone.robot(x)]).mean
    return np.where(evidence.fit, (after - before) / nominal.sd, 0.0)
