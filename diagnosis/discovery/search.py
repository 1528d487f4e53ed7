"""The search: every form is tried at all its values by one linear test, and the best ones are fitted in full.

The linear test is the score test of `inference.scan`, with both signs of a size. Whether its best result is more than
chance follows from the same test of residuals whose signs were drawn at random: chance has the same outliers and the
same number of forms to choose from, and no law (Westfall and Young, Resampling-Based Multiple Testing, 1993).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.discovery.form import LawForm
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import Contest, HypothesisFit, fits_of_contests
from diagnosis.inference.fitting.hypothesis import moved
from diagnosis.inference.fitting.likelihood import CORNER
from diagnosis.inference.fitting.projection import orthonormal
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

PROMISING = 7
"""Number of forms that are fitted in full, by each of two linear rankings."""
STARTS = 2
"""Values of a form from which fits begin."""
SIGN_DRAWS = 199
"""Draws of the signs of the residuals."""
LARGEST_MULTIPLE = 50.0
"""Largest multiple of the tried size."""
MIN_SHARE = 1e-9
"""Share of a change's square outside the fitted directions, below which it is only rounding error."""
AT_ONCE = 256
"""Values of forms that are predicted together."""
FINER, FINER_STEPS = 2, 12
"""How often the place of a jump is searched between its best value and the next ones, and at how many values."""
MIXED = 4
"""Rows of uncorrelated noise that are drawn with one sign, of a log in which rows follow each other in time."""


@dataclass(frozen=True, eq=False)
class TriedForm:
    """One form at one of its values."""

    form: LawForm
    values: tuple[float, ...]
    start: Array
    """Coordinates (P,) of the fit with the form, from which a fit may begin."""


@dataclass(frozen=True, eq=False)
class FittedLaw:
    """A form that was fitted beside a model."""

    form: LawForm
    fit: HypothesisFit
    fall: float
    """Fall of the cost of the rows of the fit."""
    heldout_fall: float
    """Fall of the cost of the held-out rows."""
    score: float
    """Fall over the rows of the fit, less a penalty for each number. Held-out rows choose nothing."""


@dataclass(frozen=True, eq=False)
class FormScan:
    """The linear test of all forms."""

    promising: tuple[tuple[LawForm, tuple[Array, ...]], ...]
    """The most promising forms, each with the coordinates where fits begin."""
    chance: float
    """Share of draws of the signs in which some form did as well as the best one."""


def scan_forms(evidence: Evidence, fit: HypothesisFit, forms: Sequence[LawForm]) -> FormScan:
    """Return the most promising of several forms beside a fit."""
    # With the robust weights, rows far off count little; with Huber's they count in proportion to their distance.
    huber = np.where(evidence.fit, np.sqrt(evidence.weight / np.maximum(1.0, np.abs(fit.z) / CORNER)), 0.0)
    tests = [_LinearTest(fit, root) for root in (fit.root_weights(), huber)]
    for some, columns in _tried(evidence, fit, forms):
        for test in tests:
            test.add(some, columns)
    tried = tests[0].tried
    if not tried:
        return FormScan((), 1.0)
    # Finer values are tried about the best ones alone, which chance has not, so they have no part in its share.
    chance = min(test.chance for test in tests)
    for _ in range(FINER):
        for some, columns in _tried(evidence, fit, _finer(tests)):
            for test in tests:
                test.add(some, columns)
    best: dict[str, tuple[LawForm, list[Array]]] = {}
    for test in tests:
        falls, multiples = np.array(test.falls), np.array(test.multiples)
        ranked: dict[str, int] = {}
        for k in np.argsort(-falls, kind="stable").tolist():
            name = tried[k].form.label
            if ranked.setdefault(name, 0) >= STARTS or (ranked[name] == 0 and len(ranked) > PROMISING):
                continue
            ranked[name] += 1
            form, starts = best.setdefault(name, (tried[k].form, []))
            starts.append(_sized(fit, form, tried[k].start, float(multiples[k])))
    return FormScan(tuple((form, tuple(starts)) for form, starts in best.values()), chance)


def fitted(
    evidence: Evidence, fit: HypothesisFit, promising: Sequence[tuple[LawForm, Sequence[Array]]]
) -> list[FittedLaw]:
    """Return each form beside a fit, with all coordinates fitted again, from the best of its starts."""
    contests = [
        Contest(evidence, [(fit.hypothesis.with_effect(form.candidate), start) for start in starts])
        for form, starts in promising
    ]
    laws = []
    for (form, _), every in zip(promising, fits_of_contests(contests), strict=True):
        after = min(every, key=lambda each: each.cost)
        fall = fit.cost - after.cost
        heldout_fall = float((fit.costs - after.costs)[evidence.heldout].sum())
        laws.append(FittedLaw(form, after, fall, heldout_fall, fall - PARAMETER_PENALTY * form.size))
    return laws


def null_start(fit: HypothesisFit, form: LawForm) -> Array:
    """Return the coordinates (P,) of a fit with a form that does nothing yet."""
    return moved(fit.x, fit.hypothesis, fit.hypothesis.with_effect(form.candidate))


def _tried(evidence: Evidence, fit: HypothesisFit, forms: Iterable[LawForm]) -> Iterator[tuple[list[TriedForm], Array]]:
    """Yield all forms at all their values, and the changes (M, N) of the prediction by them, in sigmas."""
    before = evidence.values - fit.z * fit.sd
    tried: list[tuple[TriedForm, RobotConfig]] = []
    for form in forms:
        hypothesis = fit.hypothesis.with_effect(form.candidate)
        place = hypothesis.parameters(form.candidate)
        starts = np.tile(null_start(fit, form), (len(form.tries), 1))
        for start, values in zip(starts, form.tries, strict=True):
            start[place] = [c.coordinate(v) for c, v in zip(form.candidate.coordinates, values, strict=True)]
        starts = hypothesis.clipped(starts)
        tries = (TriedForm(form, values, start) for values, start in zip(form.tries, starts, strict=True))
        tried += zip(tries, hypothesis.robots(starts), strict=True)
    for begin in range(0, len(tried), AT_ONCE):
        some, robots = zip(*tried[begin : begin + AT_ONCE], strict=True)
        mean = evidence.predicted(robots).moved(fit.whitened_change).mean
        change = (mean - before) / fit.sd
        yield list(some), np.where(evidence.fit & np.isfinite(change), change, 0.0)


class _LinearTest:
    """The fall of the weighted squares by the best multiple of a change, less the penalty, in the data and by chance.

    Args:
        fit: The fit without the changes.
        root: (N,), roots of the weights.
    """

    def __init__(self, fit: HypothesisFit, root: Array) -> None:
        self._rows = np.flatnonzero(root > 0.0)
        self._root = root[self._rows]
        basis = orthonormal(fit.tangents(root))
        residual = fit.weighted_residuals(fit.z, root)
        self._basis = basis[self._rows]
        # What the parameters explain has no part in the test or in the draws.
        self._rest = (residual - basis @ (basis.T @ residual))[self._rows]
        self._begins = runs_of_one_sign(fit.evidence, self._rows)
        draws = stream(0, "diagnosis/discovery/signs")
        self._signs = draws.choice([-1.0, 1.0], (len(self._begins), SIGN_DRAWS))
        self._by_chance = np.full(SIGN_DRAWS, -np.inf)
        self.tried: list[TriedForm] = []
        self.falls: list[float] = []
        self.multiples: list[float] = []

    def add(self, tried: Sequence[TriedForm], columns: Array) -> None:
        """Test the changes (M, N) by some forms, in sigmas."""
        penalties = PARAMETER_PENALTY * np.array([each.form.size for each in tried])[:, None]
        is_fixed = np.array([each.form.is_result for each in tried])[:, None]
        weighed = columns[:, self._rows] * self._root
        square = (weighed**2).sum(axis=1, keepdims=True)
        weighed -= (weighed @ self._basis) @ self._basis.T
        free = (weighed**2).sum(axis=1, keepdims=True)
        is_new = free > MIN_SHARE * np.maximum(square, 1e-300)
        free = np.where(is_new, free, 1.0)
        along = weighed * self._rest

        def falls(along: Array) -> tuple[Array, Array]:
            best = np.clip(along / free, -LARGEST_MULTIPLE, LARGEST_MULTIPLE)
            multiple = np.where(is_fixed, 1.0, best)
            return np.where(is_new, 2.0 * multiple * along - multiple**2 * free, -np.inf) - penalties, multiple

        fall, multiple = falls(along.sum(axis=1, keepdims=True))
        self.tried += tried
        self.falls += fall[:, 0].tolist()
        self.multiples += multiple[:, 0].tolist()
        run_sums: Array = np.add.reduceat(along, self._begins, axis=1)
        by_chance, _ = falls(run_sums @ self._signs)
        self._by_chance = np.maximum(self._by_chance, by_chance.max(axis=0))

    @property
    def chance(self) -> float:
        """Share of draws of signs whose best fall is as large."""
        return (1.0 + float(np.count_nonzero(self._by_chance >= max(self.falls)))) / (1.0 + SIGN_DRAWS)


def _finer(tests: Sequence[_LinearTest]) -> Iterator[LawForm]:
    """Yield the forms that jump, at finer values about the best one by each test."""
    for test in tests:
        best: dict[str, int] = {}
        for k, tried in enumerate(test.tried):
            if tried.form.is_worth_finer_tries and test.falls[k] > test.falls[best.setdefault(tried.form.label, k)]:
                best[tried.form.label] = k
        for k in best.values():
            yield test.tried[k].form.finer(test.tried[k].values, FINER_STEPS)


def runs_of_one_sign(evidence: Evidence, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return where the runs of rows begin that are drawn with one sign: of one quantity and one trial.

    Successive rows of a log have noise in common, which draws with a sign for each row would destroy. The rows of a
    sweep are independent, and each has its own sign.
    """
    lengths = [
        ceil(MIXED * (1.0 + correlation) / (1.0 - correlation)) if observed.is_series else 1
        for observed, correlation in zip(evidence.observed, evidence.correlations, strict=True)
    ]
    quantity, trial = evidence.quantity[rows], evidence.trial[rows]
    begins = np.flatnonzero((np.diff(quantity, prepend=-1) != 0) | (np.diff(trial, prepend=-1) != 0))
    ends = np.append(begins[1:], len(rows))
    return np.concatenate(
        [np.arange(begin, end, lengths[quantity[begin]]) for begin, end in zip(begins, ends, strict=True)]
    )


def _sized(fit: HypothesisFit, form: LawForm, start: Array, multiple: float) -> Array:
    """Return a start whose first number is multiplied."""
    if form.is_result:
        return start
    hypothesis = fit.hypothesis.with_effect(form.candidate)
    sized = start.copy()
    sized[hypothesis.parameters(form.candidate).start] *= multiple
    return hypothesis.clipped(sized)
