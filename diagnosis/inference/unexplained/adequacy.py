"""Test whether the best model is adequate, or whether structure remains in its residuals.

For each observed quantity and each covariate, flexible functions of the covariate are tested against the residuals
(score test; Godfrey, Misspecification Tests in Econometrics, 1988). The residuals are clipped, and both they and the
functions are projected onto what the fitted parameters, with their priors, cannot explain, so that a misfit that a
parameter could still remove does not count. The share of the residuals inside the span of the functions, relative to
the share outside, has the F distribution if the model is adequate, whatever the level of the noise. The p-values of all
tests are combined by Bonferroni.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect, moved
from diagnosis.inference.unexplained.bases import (
    OUTLIERS_IN_A_ROW,
    RUNS_OF_OUTLIERS,
    RUNS_OF_ROWS,
    Basis,
    bases,
    standing_out,
)
from diagnosis.inference.unexplained.outlier_clusters import APART, begins, cluster, wild
from diagnosis.inference.unexplained.score_test import CLIP, ScoreTest
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import ROW_TIME, Covariate, SharedFunctions
from symolo.core.arrays import Array

LEVEL = 0.001
"""Probability, over all tests together, of calling an adequate model inadequate."""
MIN_ROWS = 8
"""Smallest number of rows of a quantity that is tested."""
CLUSTER = "outliers at neighbouring values"
ROWS_PER_FUNCTION = 8
"""Smallest number of rows for each function that the quantities of a stage share."""
SMALL_CHANGE = 0.01
"""Share of the largest change by such functions, up to which a row counts as not changed."""
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
    further: tuple[str, ...] = ()
    """Further observed quantities that share the structure."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """Return the names of all observed quantities with the structure."""
        return (self.observed, *self.further)

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

    @property
    def changes_over_time(self) -> bool:
        """Return whether there is a significant structure over time."""
        return any(s.p < LEVEL and s.is_over_time for s in self.structures)

    def restricted_to(self, observed: str) -> "Adequacy":
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
    score_test = ScoreTest(evidence, fit, np.zeros((len(fit.z), 0)) if beside is None else beside)
    structures: list[Structure] = []
    for number, rows in enumerate(evidence.fit[place] for place in evidence.places):
        if np.count_nonzero(rows) >= MIN_ROWS:
            structures += _functions_of(evidence, fit, score_test, number)
            structures += _clusters(evidence, score_test, number)
    structures += _shared_functions(evidence, fit, score_test)
    # Bonferroni: with so many tests, one of them would reject an adequate model by chance.
    whole = [replace(structure, p=min(1.0, structure.p * len(structures))) for structure in structures]
    row_forms = (RUNS_OF_ROWS, RUNS_OF_OUTLIERS, CLUSTER)
    explained = {name for s in whole if s.p < LEVEL and s.what not in row_forms for name in s.quantities}
    # A function of a covariate also makes single rows stand out, which then add nothing.
    structures = [s for s in whole if s.what not in row_forms or s.observed not in explained]
    return Adequacy(tuple(sorted(structures, key=lambda s: (s.p, -s.explainable))))


def _functions_of(evidence: Evidence, fit: HypothesisFit, score_test: ScoreTest, number: int) -> Iterator[Structure]:
    """Yield the best function of each covariate of a quantity, and the runs of its rows that stand out most."""
    quantity, place, level = evidence.observed[number], evidence.places[number], float(fit.noise.levels[number])
    rows = evidence.fit[place]
    inside = np.arange(place.start, place.stop)[rows]
    wild_rows = wild(score_test.z[inside], quantity.trial[rows])
    runs = _independent(evidence, score_test, [number])
    session = any(covariate.name == "session_time_s" for covariate in quantity.covariates)
    along = [(rank, covariate, bases(covariate, rows)) for rank, covariate in enumerate(quantity.covariates)]
    along += [
        (rank, covariate, standing_out(score_test.residuals[inside], quantity.trial[rows], wild_rows, what))
        for rank, covariate, _ in along
        for what in (RUNS_OF_ROWS, RUNS_OF_OUTLIERS)
        # What a voltage did before it was logged lasts for some rows, so that a run of rows is no sign of a cause.
        if covariate.name == ROW_TIME and not evidence.has_early_voltages(quantity)
    ]
    rows_worth = float(evidence.weight[inside].sum())
    for rank, covariate, functions in along:
        best: Structure | None = None
        for basis in functions:
            p, gain = score_test.test(number, inside, basis, runs)
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


def _shared_functions(evidence: Evidence, fit: HypothesisFit, score_test: ScoreTest) -> Iterator[Structure]:
    """Yield the best functions that all quantities of a stage share.

    One cause in several quantities is seen where it is not significant in any of them.
    """
    first = 0
    for stage in evidence.stages:
        numbers = range(first, first + len(stage.observed))
        first += len(stage.observed)
        choices = list(zip(*(observed.shared_functions for observed in stage.observed), strict=True))
        inside = np.flatnonzero(evidence.fit & np.isin(evidence.quantity, numbers))
        level = min(float(fit.noise.levels[number]) for number in numbers)
        runs = _independent(evidence, score_test, numbers)
        best: Structure | None = None
        for shared in choices if len(inside) >= MIN_ROWS else ():
            responses = [evidence.whitened_part(k, each.responses()) for k, each in zip(numbers, shared, strict=True)]
            columns = np.zeros((len(evidence.values), responses[0].shape[1]))
            for number, response in zip(numbers, responses, strict=True):
                columns[evidence.places[number]] = response
            columns = np.where(evidence.fit[:, None], columns / fit.sd[:, None], 0.0)
            columns = columns[:, _enough_rows(columns)]
            if columns.shape[1] == 0 or ROWS_PER_FUNCTION * columns.shape[1] > len(inside):
                continue
            p, gain = score_test.test(numbers[0], inside, Basis(columns[inside], shared[0].what), runs)
            p = min(1.0, p * len(choices)) if gain * level**2 >= MATERIAL else 1.0
            if best is None or p < best.p:
                best = _shared_structure(evidence, numbers, shared[0], columns, p, gain)
        if best is not None:
            yield best


def _independent(evidence: Evidence, score_test: ScoreTest, numbers: Sequence[int]) -> NDArray[np.intp]:
    """Return the places, among the samples of quantities, at which a row begins or a run of outliers of one mistake."""
    starts = []
    for number in numbers:
        quantity, place = evidence.observed[number], evidence.places[number]
        rows = evidence.fit[place]
        is_wild = wild(score_test.z[place][rows], quantity.trial[rows]) & quantity.is_series
        starts.append(begins(is_wild))
    return np.flatnonzero(np.concatenate(starts))


def _enough_rows(columns: Array) -> Mask:
    """Return the columns (k,) that change enough rows."""
    size = np.abs(columns)
    return np.asarray(np.count_nonzero(size > SMALL_CHANGE * size.max(initial=0.0), axis=0) >= MIN_ROWS)


def _shared_structure(  # noqa: PLR0917 - a set of functions, and the result of its test
    evidence: Evidence, numbers: range, shared: SharedFunctions, columns: Array, p: float, gain: float
) -> Structure:
    """Return the structure by functions that the quantities of a stage share."""
    observed = evidence.observed[numbers[0]]
    rows = evidence.fit & np.isin(evidence.quantity, numbers)
    return Structure(
        observed=observed.name,
        channel=observed.channel,
        covariate=shared.covariate,
        what=shared.what,
        p=p,
        explainable=gain,
        rank=[covariate.name for covariate in observed.covariates].index(shared.covariate),
        basis=columns,
        size=float(np.sqrt(gain / evidence.weight[rows].sum())),
        is_over_time=False,
        further=tuple(evidence.observed[number].name for number in numbers[1:]),
    )


def _clusters(evidence: Evidence, score_test: ScoreTest, number: int) -> Iterator[Structure]:
    """Yield the outliers of a quantity that gather along each covariate, where there are any."""
    quantity, place = evidence.observed[number], evidence.places[number]
    # Outliers are readings. What a motor does for a row lasts longer in its speed, unlike an error of the logger.
    rows, whitening = evidence.fit[place], evidence.whitenings[number]
    z = evidence.unwhitened(number, score_test.z[place])
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


def change_by(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect) -> Array:
    """Return the change (N,) of the nominal prediction by a fitted effect alone, in sigmas; 0 outside the fit."""
    alone = nominal.hypothesis.with_effect(effect)
    x = moved(nominal.x, nominal.hypothesis, alone)
    x[alone.parameters(effect)] = fit.x[fit.hypothesis.parameters(effect)]
    before, after = evidence.predicted([nominal.robot, alone.robot(x)]).mean
    return np.where(evidence.fit, (after - before) / nominal.sd, 0.0)
