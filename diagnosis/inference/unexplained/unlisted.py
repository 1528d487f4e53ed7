"""Causes in no list, as rivals of the named effects and of outliers, by the same cost.

Effects of the list are flexible enough to imitate many a cause that is in none, and leave no structure then. And a few
rows far off are cheap if they are outliers. So errors of simple form (`forms`) compete with both: each is fitted beside
a model, with all coordinates linearised, with noise and outliers fitted again. PARAMETER_PENALTY is added for its size
and for each number that was chosen for it, as for each parameter of an effect. Outliers have random sizes, so that no
form goes through them. The rows of a bench are separate states, so that errors of any simple shape are tried; of a time
series, only those that the model itself describes (`series_forms`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from math import exp

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.memoized import memoized
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.likelihood import CORNER, costs_of_residuals, fitted_noise, weights
from diagnosis.inference.fitting.noise_effects import fixed_levels
from diagnosis.inference.fitting.projection import orthonormal
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY
from diagnosis.inference.selection.removal import without
from diagnosis.inference.unexplained.adequacy import Adequacy, Structure, adequacy, may_be_of_logger
from diagnosis.inference.unexplained.equivalent_errors import is_error_of_own_effect
from diagnosis.inference.unexplained.forms import CHANGED, Bump, Form, forms
from diagnosis.inference.unexplained.series_forms import series_forms
from diagnosis.measured.channel import Mask
from diagnosis.nuisances import Nuisance
from symolo.core.arrays import Array

MAX_SAMPLES = 2000
"""Largest number of samples with the forms of a bench. With more of them, `adequacy` sees what the forms would."""
MIN_ROWS = 8
"""Smallest number of rows of a quantity that is tested."""
PROMISING = 8
"""Number of forms that are fitted, by each of two linear rankings."""
PROMISING_OF_SERIES = 2
"""The same for a time series, which has few forms and many samples."""
ALIKE = 2
"""Largest number of forms among them of one kind along one covariate."""
ALIKE_FALL = 1.0
"""Difference of the cost up to which two forms are equal; then that along the first covariate is reported."""
REFINED = 1
"""Number of bumps by each ranking whose middle and width are fitted too."""
REFINEMENTS = 40
"""Largest number of fits with other middles and widths of a bump."""
MORE_THAN_OUTLIERS = 9.0
"""Smallest fall of the cost of those rows that a form does not go through anyway; three standard errors."""
BETWEEN = (0.25, 0.5, 0.75)
"""Shares of the way from one form to the next, where the number that was chosen may lie."""
IMITATES = 3.0
"""Deviation in tolerances from which a nominal parameter may imitate an error."""
SIZE_IN_TOLERANCES = 0.1
"""Size of a form that is fitted again, in standard deviations of a prior that hardly matters."""
FORBIDDEN = 1e9
"""Cost of a bump outside the data."""
SETTLED = 0.05
"""Fall of the cost from which another round is worth its time."""
ROUNDS = 6
"""Fits of size and coordinates in turn with noise and weights."""
BETTER = 4.6
"""Advantage of a form over the effects in its place, from which these are only substitutes for it: its weight is then
ten times theirs. Beside 90 right names in independent benches (docs/diagnosis_evaluation.md, seed 202), every form was
behind by at least 2.7."""
WIDTHS = (0.02, 0.4)
"""Smallest and largest width of a bump, as a share of the range of its covariate."""


@dataclass(frozen=True)
class FittedForm:
    """A form beside a model."""

    quantity: int
    """Index of the observed quantity."""
    form: Form
    column: Array
    """(N,), change of the residuals by the fitted form, in sigmas of the model."""
    fall: float
    """Fall of the cost of the model by the form, with a penalty for each of its numbers."""
    heldout_fall: float
    """Fall of the cost of the held-out rows, which do not count in a time series."""
    explainable: float
    """Fall of the cost without a penalty."""
    beyond_chance: float
    """Fall of the cost of the rows of the fit without the largest falls, as many as the form has numbers: with them, it
    can go through as many outliers."""
    kinds: int = 1
    """Number of kinds of forms, along all covariates, of which this one is the best."""
    refit: HypothesisFit | None = None
    """The fit with the form, where everything else is fitted again exactly; None where it is linearised."""


def with_forms(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, result: Adequacy) -> Adequacy:
    """Return the structures of a fit with the form that explains more than its effects, or else the best beside them.

    If the fit leaves a structure, a form of a time series takes its place only if it leaves none.

    The probability of a form by chance is exp(-fall / 2), a penalised likelihood ratio, times the number of kinds of
    forms (Bonferroni).
    """
    if result.has_cause and not any(quantity.is_series for quantity in evidence.observed):
        return result
    bases = [nominal] if len(fit.hypothesis.effects) == 1 else []
    if len(fit.hypothesis.effects) > 1:
        bases = [nominal, *(without(evidence, fit, effect) for effect in fit.hypothesis.effects)]
    rivals = [(advantage(evidence, base, fit), best_form(evidence, base)) for base in bases]
    better = [
        (ahead, form)
        for base, (ahead, form) in zip(bases, rivals, strict=True)
        if form is not None and ahead >= BETTER and (not result.has_cause or _leaves_nothing(evidence, base, form))
    ]
    if result.has_cause and not better:
        return result
    if better:
        ahead, form = max(better, key=lambda pair: pair[0])
        strongest = _structure(evidence, form, explainable=ahead, is_of_outliers=False)
    elif (beside := best_form(evidence, fit)) is not None:
        strongest = _structure(evidence, beside, beside.explainable, is_of_outliers=_may_be_of_logger(evidence, beside))
    else:
        return result
    return Adequacy(tuple(sorted((strongest, *result.structures), key=lambda structure: structure.p)))


def advantage(evidence: Evidence, base: HypothesisFit, fit: HypothesisFit) -> float:
    """Return by how much the best form beside a base explains more than the effects by which a fit goes beyond it.

    Log-likelihoods of fitted and held-out rows add up on a bench. The held-out trials of a time series do not count: a
    model is extrapolated to them, and what the fitted trials leave open would decide. Each number has the penalty of a
    parameter. A form that is the same error as effects of the user's own is no rival of them.
    """
    form = best_form(evidence, base)
    if form is None or is_error_of_own_effect(base, fit, form.column[:, None]):
        return -np.inf
    heldout = _heldout(evidence, form.quantity)
    numbers = len(fit.x) - len(base.x)
    by_effects = base.cost - fit.cost - PARAMETER_PENALTY * numbers + float((base.costs - fit.costs)[heldout].sum())
    return form.fall + form.heldout_fall - by_effects


def _heldout(evidence: Evidence, number: int) -> Mask:
    """Return the held-out samples (N,) that count for a form of a quantity: none in a time series."""
    return evidence.heldout & (not evidence.observed[number].is_series)


def _structure(evidence: Evidence, fitted: FittedForm, explainable: float, *, is_of_outliers: bool) -> Structure:
    observed, form = evidence.observed[fitted.quantity], fitted.form
    rows = evidence.fit[evidence.places[fitted.quantity]]
    return Structure(
        observed=observed.name,
        channel=observed.channel,
        covariate=form.covariate,
        what=form.what,
        p=min(1.0, fitted.kinds * exp(-0.5 * max(0.0, fitted.fall + fitted.heldout_fall))),
        explainable=explainable,
        rank=form.rank,
        basis=np.where(evidence.fit, fitted.column, 0.0)[:, None],
        size=float(np.sqrt(max(0.0, fitted.explainable) / np.count_nonzero(rows))),
        is_over_time=False,
        is_of_outliers=is_of_outliers,
    )


def _may_be_of_logger(evidence: Evidence, fitted: FittedForm) -> bool:
    """Return whether a form changes only a run of rows that a logger can cause."""
    place = evidence.places[fitted.quantity]
    change = np.where(evidence.fit[place], np.abs(fitted.column[place]), 0.0)
    return may_be_of_logger(change > CHANGED * change.max(initial=0.0))


@memoized
def best_form(evidence: Evidence, fit: HypothesisFit) -> FittedForm | None:
    """Return the form that lowers the cost of a fit most, penalties included; None if no form can be tested."""
    listed = list(_bench_forms(evidence, fit))
    count = PROMISING if listed else PROMISING_OF_SERIES
    listed += series_forms(evidence, fit)
    if not listed:
        return None
    columns = np.stack([column for _, _, column in listed])
    fitted = []
    # With the robust weights, rows far off count little; with Huber's they count in proportion to their distance.
    huber = np.where(evidence.fit, evidence.weight / np.maximum(1.0, np.abs(fit.z) / CORNER), 0.0)
    for weight in (fit.root_weights() ** 2, huber):
        best = list(islice(_promising(fit, listed, columns, np.sqrt(weight)), count))
        tried = [_fitted(evidence, fit, *listed[k], weight) for k, _ in best]
        # Without a fall of the weighted squares, no other middle and width will matter.
        bumps = [
            f for f, (_, fall) in zip(tried, best, strict=True) if isinstance(f.form, Bump) and fall > PARAMETER_PENALTY
        ]
        fitted += [*tried, *(_refined(evidence, fit, bump, weight) for bump in bumps[:REFINED])]
        fitted += _between(evidence, fit, [listed[k] for k, _ in best], weight)
    more_than_outliers = [f for f in fitted if f.beyond_chance >= MORE_THAN_OUTLIERS]
    if not more_than_outliers:
        return None
    top = max(f.fall for f in more_than_outliers)
    # Along a sweep, voltage, current and speed grow together, so that a form is the same along each of them.
    best = min((f for f in more_than_outliers if f.fall >= top - ALIKE_FALL), key=lambda f: (f.form.rank, -f.fall))
    # Parameters far off, which imitate the error, return into their tolerances beside it: too far for a linear fit.
    best = _refitted(evidence, fit, best) if _is_imitated(fit) else best
    return replace(best, kinds=len({(number, form.covariate, form.what) for number, form, _ in listed}))


def _bench_forms(evidence: Evidence, fit: HypothesisFit) -> Iterator[tuple[int, Form, Array]]:
    """Yield the forms of each quantity whose rows are separate states, with their columns (N,) in sigmas."""
    if np.count_nonzero(evidence.fit) > MAX_SAMPLES:
        return
    for number, place in enumerate(evidence.places):
        for form in _forms_of(evidence, fit, number):
            column = np.zeros(len(fit.z))
            column[place] = form.column / fit.sd[place]
            yield number, form, column


def _forms_of(evidence: Evidence, fit: HypothesisFit, number: int) -> Sequence[Form]:
    """Return the forms of an observed quantity, whose rows must be separate states.

    In a time series errors last for many rows, and would follow one form or another by chance.
    """
    quantity, place = evidence.observed[number], evidence.places[number]
    if quantity.is_series:
        return ()
    rows = evidence.fit[place]
    # The residual of a sample of which only a state is known is no error in the unit of the quantity.
    if quantity.is_state is not None:
        rows = rows & ~quantity.is_state
    if np.count_nonzero(rows) < MIN_ROWS:
        return ()
    predicted = evidence.values[place] - fit.z[place] * fit.sd[place]
    return tuple(forms(quantity, np.where(np.isfinite(predicted), predicted, 0.0), rows))


def _promising(
    fit: HypothesisFit, listed: Sequence[tuple[int, Form, Array]], columns: Array, root: Array
) -> Iterator[tuple[int, float]]:
    """Yield which forms lower the weighted squares most, and the fall, less the penalties of the chosen numbers."""
    basis = orthonormal(fit.tangents(root))
    residual = fit.weighted_residuals(fit.z, root)
    residual -= basis @ (basis.T @ residual)
    weighed = columns * root
    squares = (weighed**2).sum(axis=1)
    free = squares - ((weighed @ basis[: len(root)]) ** 2).sum(axis=1)
    falls = np.where(free > 1e-6 * squares, (weighed @ residual[: len(root)]) ** 2 / np.maximum(free, 1e-300), -np.inf)
    falls -= PARAMETER_PENALTY * np.array([form.chosen for _, form, _ in listed])
    seen: dict[tuple[int, str, str], int] = {}
    for k in np.argsort(-falls, kind="stable").tolist():
        number, form, _ = listed[k]
        kind = number, form.covariate, form.what
        seen[kind] = seen.get(kind, 0) + 1
        if np.isfinite(falls[k]) and seen[kind] <= ALIKE:
            yield k, float(falls[k])


def _fitted(  # noqa: PLR0917 - a form, and where the fit starts
    evidence: Evidence, fit: HypothesisFit, number: int, form: Form, column: Array, weight: Array
) -> FittedForm:
    """Return a form with its size, beside the coordinates of a fit and the noise, all of them fitted again."""
    rows, nuisances = evidence.fit, len(fit.hypothesis.nuisances)
    design = np.concatenate([column[None], fit.slopes])
    is_level_fixed = fixed_levels(evidence, fit.hypothesis, fit.spreads)
    has_prior = (np.arange(len(design)) >= 1) & (np.arange(len(design)) <= nuisances)
    prior = np.zeros(len(design))
    prior[has_prior] = fit.hypothesis.prior(fit.x)
    level = fit.noise.levels[evidence.quantity]
    sd, noise = fit.sd / level, fit.noise
    best_cost, best_costs, best_size = np.inf, fit.costs, 0.0
    for _ in range(ROUNDS):
        normal = (design * weight) @ design.T + np.diag(has_prior.astype(float))
        step = np.linalg.lstsq(normal, (design * weight) @ fit.z - prior, rcond=1e-12)[0]
        z = (fit.z - step @ design) * level
        noise = fitted_noise(evidence, z, sd, noise, is_level_fixed)
        fitted_level = noise.levels[evidence.quantity]
        costs = costs_of_residuals(evidence, z / fitted_level, sd * fitted_level, noise)
        cost = float(costs[rows].sum() + ((prior + step)[has_prior] ** 2).sum()) + fit.by_tolerances + noise.prior_cost
        fallen = best_cost - cost
        if fallen > 0.0:
            best_cost, best_costs, best_size = cost, costs, float(step[0])
        if fallen < SETTLED:
            break
        row_weights, _ = weights(evidence, z / fitted_level, sd * fitted_level, noise)
        weight = np.where(rows, evidence.weight * row_weights * (level / fitted_level) ** 2, 0.0)
    heldout_fall = float((fit.costs - best_costs)[_heldout(evidence, number)].sum())
    fall, numbers = fit.cost - best_cost, 1 + form.chosen
    falls = np.maximum((fit.costs - best_costs)[rows], 0.0)
    beyond_chance = float(np.sort(falls)[: len(falls) - numbers].sum())
    return FittedForm(
        number, form, best_size * column, fall - PARAMETER_PENALTY * numbers, heldout_fall, fall, beyond_chance
    )


def _between(
    evidence: Evidence, fit: HypothesisFit, best: Sequence[tuple[int, Form, Array]], weight: Array
) -> Iterator[FittedForm]:
    """Yield forms of a time series between the two best, if these differ only in a number chosen from a list.

    Of a bench, a mixture of two steps or bumps would be another form, with more numbers.
    """
    if len(best) < ALIKE:
        return
    (number, form, column), (other_number, other, other_column) = best[:ALIKE]
    is_one_number = form.chosen == 1 and evidence.observed[number].is_series
    if is_one_number and (number, form.covariate, form.what) == (other_number, other.covariate, other.what):
        for share in BETWEEN:
            yield _fitted(evidence, fit, number, form, (1.0 - share) * column + share * other_column, weight)


def _refitted(evidence: Evidence, fit: HypothesisFit, fitted: FittedForm) -> FittedForm:
    """Return a form of a time series with everything else fitted again exactly; others as they are."""
    hypothesis = fit.hypothesis
    if hypothesis.fixed or not evidence.observed[fitted.quantity].is_series:
        return fitted
    # At its size the form is a tenth of its tolerance, so that the prior on its size hardly matters.
    by_place = [
        evidence.unwhitened(k, (fitted.column * fit.sd)[place] / SIZE_IN_TOLERANCES)
        for k, place in enumerate(evidence.places)
    ]
    size = Nuisance("form", 0.0, 1.0, "", lambda robot, _: robot, np.concatenate(by_place))
    nuisances = len(hypothesis.nuisances)
    with_form = replace(hypothesis, nuisances=(*hypothesis.nuisances, size))
    starts = [np.insert(x, nuisances, SIZE_IN_TOLERANCES) for x in (fit.x, _within_tolerances(fit))]
    refit = min(fits(evidence, [(with_form, x) for x in starts]), key=lambda each: each.cost)
    share, fall = float(refit.x[nuisances]) / SIZE_IN_TOLERANCES, fit.cost - refit.cost
    falls = np.maximum((fit.costs - refit.costs)[evidence.fit], 0.0)
    numbers = 1 + fitted.form.chosen
    return replace(
        fitted,
        column=share * fitted.column,
        fall=fall - PARAMETER_PENALTY * numbers,
        explainable=fall,
        beyond_chance=float(np.sort(falls)[: len(falls) - numbers].sum()),
        refit=refit,
    )


def _is_imitated(fit: HypothesisFit) -> bool:
    """Return whether nominal parameters are so far off that they may imitate an error."""
    return bool(np.abs(fit.x[: len(fit.hypothesis.nuisances)]).max(initial=0.0) >= IMITATES)


def _within_tolerances(fit: HypothesisFit) -> Array:
    """Return the coordinates of a fit with all nuisances at their nominal values."""
    return np.where(np.arange(len(fit.x)) < len(fit.hypothesis.nuisances), 0.0, fit.x)


def _leaves_nothing(evidence: Evidence, base: HypothesisFit, fitted: FittedForm) -> bool:
    """Return whether a base with a form of a time series leaves no structure with an unknown cause."""
    refit = fitted.refit or _refitted(evidence, base, fitted).refit
    return refit is not None and not adequacy(evidence, refit).has_cause


def _refined(evidence: Evidence, fit: HypothesisFit, fitted: FittedForm, weight: Array) -> FittedForm:
    """Return a bump with the middle and the width that lower the cost most."""
    from scipy.optimize import minimize  # noqa: PLC0415 - takes long to load, and few diagnoses come here

    bump = fitted.form
    if not isinstance(bump, Bump):
        return fitted
    place = evidence.places[fitted.quantity]
    inside = bump.size[evidence.fit[place] & np.isfinite(bump.size)]
    low, high = float(inside.min()), float(inside.max())
    best = fitted

    def rise(at: Array) -> float:
        nonlocal best
        middle, width = bump.middle + float(at[0]) * bump.width, bump.width * float(np.exp(at[1]))
        if not low <= middle <= high or not WIDTHS[0] <= width / (high - low) <= WIDTHS[1]:
            return FORBIDDEN
        moved = bump.moved(middle, width)
        column = np.zeros(len(fit.z))
        column[place] = moved.column / fit.sd[place]
        tried = _fitted(evidence, fit, fitted.quantity, moved, column, weight)
        best = tried if tried.fall > best.fall else best
        return -tried.fall

    simplex = np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 0.4]])
    minimize(rise, simplex[0], method="Nelder-Mead", options={"maxfev": REFINEMENTS, "initial_simplex": simplex})
    return best
