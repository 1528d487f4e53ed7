"""The search: every form is tried at all its values by one linear test, and the best ones are fitted in full.

The linear test is the score test of `inference.scan`, with both signs of a size. Whether its best result is more than
chance follows from the same test of residuals whose signs were drawn at random: chance has the same outliers and the
same number of forms to choose from, and no law (Westfall and Young, Resampling-Based Multiple Testing, 1993).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.form import LawForm
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import HypothesisFit, fits
from diagnosis.inference.hypothesis import moved
from diagnosis.inference.likelihood import CORNER
from diagnosis.inference.projection import orthonormal
from diagnosis.inference.selection import TOLL
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
AT_ONCE = 96
"""Values of a form that are predicted together."""


@dataclass(frozen=True, eq=False)
class TriedForm:
    """One form at one of its values."""

    form: LawForm
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
    """Fall over the rows of the fit, less a toll for each number. Held-out rows choose nothing."""


@dataclass(frozen=True, eq=False)
class FormScan:
    """The linear test of all forms."""

    promising: tuple[tuple[LawForm, tuple[Array, ...]], ...]
    """The most promising forms, each with the coordinates where fits begin."""
    chance: float
    """Share of draws of the signs in which some form did as well as the best one."""


def scan_forms(evidence: Evidence, fit: HypothesisFit, forms: Sequence[LawForm]) -> FormScan:
    """Return the most promising of several forms beside a fit."""
    tried, columns = _tried(evidence, fit, forms)
    if not tried:
        return FormScan((), 1.0)
    tolls = TOLL * np.array([each.form.size for each in tried])
    is_fixed = np.array([each.form.is_result for each in tried])
    # With the robust weights, rows far off count little; with Huber's they count in proportion to their distance.
    huber = np.where(evidence.fit, np.sqrt(evidence.weight / np.maximum(1.0, np.abs(fit.z) / CORNER)), 0.0)
    best: dict[str, tuple[LawForm, list[Array]]] = {}
    chances = []
    for root in (fit.root_weights(), huber):
        falls, multiples, chance = _linear(fit, columns, root, is_fixed, tolls)
        chances.append(chance)
        ranked: dict[str, int] = {}
        for k in np.argsort(-falls, kind="stable").tolist():
            name = tried[k].form.label
            if ranked.setdefault(name, 0) >= STARTS or (ranked[name] == 0 and len(ranked) > PROMISING):
                continue
            ranked[name] += 1
            form, starts = best.setdefault(name, (tried[k].form, []))
            starts.append(_sized(fit, form, tried[k].start, float(multiples[k])))
    return FormScan(tuple((form, tuple(starts)) for form, starts in best.values()), min(chances))


def fitted(evidence: Evidence, fit: HypothesisFit, form: LawForm, starts: Sequence[Array]) -> FittedLaw:
    """Return a form beside a fit, with all coordinates fitted again, from the best of some starts."""
    hypothesis = fit.hypothesis.with_effect(form.candidate)
    after = min(fits(evidence, [(hypothesis, start) for start in starts]), key=lambda each: each.cost)
    fall = fit.cost - after.cost
    heldout_fall = float((fit.costs - after.costs)[evidence.heldout].sum())
    return FittedLaw(form, after, fall, heldout_fall, fall - TOLL * form.size)


def null_start(fit: HypothesisFit, form: LawForm) -> Array:
    """Return the coordinates (P,) of a fit with a form that does nothing yet."""
    return moved(fit.x, fit.hypothesis, fit.hypothesis.with_effect(form.candidate))


def _tried(evidence: Evidence, fit: HypothesisFit, forms: Sequence[LawForm]) -> tuple[list[TriedForm], Array]:
    """Return all forms at all their values, and the changes (M, N) of the prediction by them, in sigmas."""
    tried: list[TriedForm] = []
    columns = []
    before = evidence.values - fit.z * fit.sd
    for form in forms:
        hypothesis = fit.hypothesis.with_effect(form.candidate)
        place = hypothesis.parameters(form.candidate)
        starts = np.tile(null_start(fit, form), (len(form.tries), 1))
        for start, values in zip(starts, form.tries, strict=True):
            start[place] = [c.coordinate(v) for c, v in zip(form.candidate.coordinates, values, strict=True)]
        starts = hypothesis.clipped(starts)
        for begin in range(0, len(starts), AT_ONCE):
            some = starts[begin : begin + AT_ONCE]
            mean = evidence.predicted(hypothesis.robots(some)).moved(fit.local_change).mean
            change = (mean - before) / fit.sd
            columns.append(np.where(evidence.fit & np.isfinite(change), change, 0.0))
            tried += [TriedForm(form, start) for start in some]
    return tried, np.concatenate(columns) if columns else np.zeros((0, len(fit.z)))


def _linear(
    fit: HypothesisFit, columns: Array, root: Array, is_fixed: Array, tolls: Array
) -> tuple[Array, Array, float]:
    """Return the fall of the weighted squares by the best multiple of each column, less the toll, and the chance.

    Args:
        fit: The fit without the columns.
        columns: (M, N), changes in sigmas.
        root: (N,), roots of the weights.
        is_fixed: (M,), columns of which the multiple is 1.
        tolls: (M,).

    Returns:
        The falls and the multiples (M,), and the share of draws of signs whose best fall is as large.
    """
    basis = orthonormal(fit.tangents(root))
    rows = np.flatnonzero(root > 0.0)
    residual = fit.weighted_residuals(fit.z, root)
    weighed = (columns * root)[:, rows]
    taken = weighed @ basis[rows]
    free = (weighed**2).sum(axis=1) - (taken**2).sum(axis=1)
    is_new = free > MIN_SHARE * np.maximum((weighed**2).sum(axis=1), 1e-300)

    def falls(along: Array) -> tuple[Array, Array]:
        square = np.where(is_new, free, 1.0)[:, None]
        best = np.clip(along / square, -LARGEST_MULTIPLE, LARGEST_MULTIPLE)
        multiple = np.where(is_fixed[:, None], 1.0, best)
        fall = 2.0 * multiple * along - multiple**2 * square
        return np.where(is_new[:, None], fall, -np.inf) - tolls[:, None], multiple

    along = weighed @ residual[rows] - taken @ (basis.T @ residual)
    fall, multiple = falls(along[:, None])
    # What the parameters explain has no part in the draws.
    rest = (residual - basis @ (basis.T @ residual))[rows]
    signs = stream(0, "diagnosis/discovery/signs").choice([-1.0, 1.0], (len(rows), SIGN_DRAWS))
    drawn = rest[:, None] * signs
    by_chance, _ = falls(weighed @ drawn - taken @ (basis[rows].T @ drawn))
    largest = by_chance.max(axis=0)
    chance = (1.0 + float(np.count_nonzero(largest >= fall.max()))) / (1.0 + SIGN_DRAWS)
    return fall[:, 0], multiple[:, 0], chance


def _sized(fit: HypothesisFit, form: LawForm, start: Array, multiple: float) -> Array:
    """Return a start whose first number is multiplied."""
    if form.is_result:
        return start
    hypothesis = fit.hypothesis.with_effect(form.candidate)
    sized = start.copy()
    sized[hypothesis.parameters(form.candidate).start] *= multiple
    return hypothesis.clipped(sized)
