"""Test whether something changed at one moment, and the named effects are only substitutes for it.

A screw that becomes loose or a sensor that is hit shifts all later readings. Two or three named effects can imitate
that so well that hardly any structure remains along time. So the nominal model with a jump competes with them: from one
moment on, each quantity may have a constant offset, a constant offset against its sign, and an offset in proportion to
itself (Chow, Econometrica 28 (1960) 591-605, with a search for the moment). Or a single nominal number has another
value from then on, such as the friction of a wheel in which a hair is caught, and changes several quantities at once.
One of the named effects may also be present from that moment on only. If this explains the same rows better, with a
penalty for each parameter, and leaves no structure in the stages that it changes, the named effects are withdrawn.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.projection import beyond, orthonormal
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY
from diagnosis.inference.selection.refusal import is_of_noise
from diagnosis.inference.unexplained.adequacy import LEVEL, Structure, adequacy, change_by
from diagnosis.inference.unexplained.equivalent_errors import is_error_of_own_effect
from diagnosis.measured.channel import Mask
from diagnosis.nuisances import Nuisance
from diagnosis.predictors.base import Covariate, CovariateShape, Observed
from symolo.core.arrays import Array

TIMES = ("session_time_s", "t_s")
"""Covariates with the time since a measurement began; the first that a stage has is used."""
MOMENTS = 40
"""Number of moments that are tried, at quantiles of the rows."""
MOMENT_PARAMETERS = 2
"""Number of parameters as which the moment counts, since the best of MOMENTS is taken."""
MAX_NOISE_RATIO = 2.0
"""Ratio of the noise of a sample by two models, relative to that of the other samples, up to which it is the same."""
MIN_ROWS = 5
"""Rows on either side of a moment."""


def change_in_time(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit) -> Structure | None:
    """Return a jump that explains more than the effects of a fit; None if there is none, or the fit has no effects."""
    if not fit.hypothesis.effects:
        return None
    root = np.where(_same_noise(evidence, nominal, fit), fit.root_weights(), 0.0)
    rest = fit.weighted_residuals(fit.z * fit.sd / nominal.sd, root)
    numbers = fit.hypothesis.size - nominal.hypothesis.size
    # Both models are compared with the nominal noise. If an effect changes the noise, its level scales the squares.
    changes_noise = any(is_of_noise(fit, effect) for effect in fit.hypothesis.effects)
    level = float(rest @ rest) / np.count_nonzero(root) if changes_noise else 1.0
    named = float(rest @ rest) / level
    basis = orthonormal(nominal.tangents(root))
    residual = nominal.weighted_residuals(nominal.z, root)
    residual = residual - basis @ (basis.T @ residual)
    best = _best_jump(evidence, nominal, fit, root, projected=(basis, residual), level=level)
    if best is None or best.squares >= named + PARAMETER_PENALTY * numbers:
        return None
    squares, columns = best.squares, best.columns
    if is_error_of_own_effect(nominal, fit, columns):
        return None
    if _leaves_structure(evidence, nominal, columns):
        return None
    fallen = residual[: len(root)] ** 2 - _left(columns * root[:, None], basis, residual)[: len(root)] ** 2
    largest = int(np.argmax([float(fallen[place].sum()) for place in evidence.places]))
    observed = evidence.observed[largest]
    rank, covariate = _along(observed, evidence.fit[evidence.places[largest]])
    return Structure(
        observed=observed.name,
        channel=observed.channel,
        covariate=covariate.name,
        what=f"jump at {best.moment_s:.4g} s",
        p=0.0,
        explainable=named - squares + PARAMETER_PENALTY * (numbers + columns.shape[1]),
        rank=rank,
        basis=columns,
        size=float(np.sqrt(max(0.0, named - squares) / np.count_nonzero(root))),
        # Speeds from counts have no zero that may drift: a jump of them has a cause, even if rows show little of it.
        is_over_time=observed.count_noise is None,
    )


@dataclass(frozen=True)
class _Jump:
    """Change of the predictions from one moment on."""

    squares: float
    """Sum of the squares of the residuals beside it, in units of the noise, with a penalty for its parameters."""
    moment_s: float
    columns: Array
    """(N, k), changes of the samples by its parameters."""


def _best_jump(
    evidence: Evidence,
    nominal: HypothesisFit,
    fit: HypothesisFit,
    root: Array,
    *,
    projected: tuple[Array, Array],
    level: float,
) -> _Jump | None:
    """Return the jump that explains most, of all moments and kinds; None if there is none.

    Args:
        evidence: The observations.
        nominal: The fit of the nominal robot.
        fit: The fit with effects, each of which may also be present from a moment on only.
        root: (N,), square roots of the weights of the samples.
        projected: Orthonormal basis of the changes by the nuisances, and the weighted residuals beyond it.
        level: Level of the noise, by which squares are divided.
    """
    lasting, time, (basis, residual) = _lasting(evidence, nominal, fit), _time_s(evidence), projected
    best: _Jump | None = None
    for moment in _moments(time[evidence.fit & np.isfinite(time)]):
        after = time >= moment
        parts = ((part.change * after[:, None], part.shape, part.limit) for part in lasting)
        for columns, shape, limit in ((_jump(evidence, nominal, after), 0, -np.inf), *parts):
            weighed = columns * root[:, None]
            combined = beyond(weighed, basis[: len(root)].T @ weighed)
            along = combined.T @ (weighed.T @ residual[: len(root)])
            if np.any(combined @ along <= limit):
                continue
            # The selection of effects has the same penalty, so that the two models can be compared.
            penalty = PARAMETER_PENALTY * (combined.shape[1] + shape + MOMENT_PARAMETERS)
            squares = float(residual @ residual - along @ along) / level + penalty
            if best is None or squares < best.squares:
                best = _Jump(squares, moment, columns)
    return best


def _leaves_structure(evidence: Evidence, nominal: HypothesisFit, columns: Array) -> bool:
    """Return whether a jump (N, k) leaves structure in a stage that it changes, so that it is only another substitute.

    Each stage is predicted from what was measured at its input, so that structure in another stage has another cause,
    and outliers in successive rows favour neither a jump nor the effects.
    """
    rows = np.abs(columns[evidence.fit]).sum(axis=1) > 0.0
    changed = set(evidence.stage_index[evidence.fit][rows].tolist())
    stages = [number for number, stage in enumerate(evidence.stages) for _ in stage.observed]
    names = {observed.name for observed, stage in zip(evidence.observed, stages, strict=True) if stage in changed}
    left = adequacy(evidence, nominal, columns).structures
    return any(s.p < LEVEL and s.observed in names and not s.is_of_outliers for s in left)


def _left(weighed: Array, basis: Array, residual: Array) -> Array:
    """Return the weighted residuals (N + P,) without what some columns explain in addition to a basis.

    Args:
        weighed: (N, k), weighted columns.
        basis: (N + P, p), orthonormal.
        residual: (N + P,), weighted residuals outside the basis.
    """
    taken = basis[: len(weighed)].T @ weighed
    combined = beyond(weighed, taken)
    along = combined.T @ (weighed.T @ residual[: len(weighed)])
    padded = np.concatenate([weighed, np.zeros((len(residual) - len(weighed), weighed.shape[1]))])
    return residual - (padded @ combined - basis @ (taken @ combined)) @ along


@dataclass(frozen=True)
class _Lasting:
    """A change that may be present from a moment on only."""

    change: Array
    """(N, 1), in sigmas."""
    shape: int = 0
    """Number of parameters of its shape."""
    limit: float = -np.inf
    """Multiple of the change that must be exceeded."""


def _lasting(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit) -> list[_Lasting]:
    """Return the changes by nominal numbers and by the effects of a fit."""
    numbers = zip(nominal.hypothesis.nuisances, nominal.slopes, strict=False)
    by_numbers = [
        _Lasting(slope[:, None], limit=_lowest_multiple(nuisance))
        for nuisance, slope in numbers
        if nuisance.change is None
    ]
    # An effect has its fitted shape, whose numbers are parameters like the size.
    by_effects = [
        _Lasting(change_by(evidence, nominal, fit, effect)[:, None], len(effect.coordinates) - 1)
        for effect in fit.hypothesis.effects
        if not is_of_noise(fit, effect)
    ]
    return [*by_numbers, *by_effects]


def _lowest_multiple(nuisance: Nuisance) -> float:
    """Return the jump of a number, in tolerances, from its nominal value to zero; a number that is positive stays so.

    Where speed and voltage are nearly constant, no possible inertia changes a prediction. But the controller answers
    the rounding of the counts, row by row, and an inertia of several times its value, below zero, has the same shape.
    """
    return -nuisance.value / nuisance.tolerance if nuisance.value > 0.0 else -np.inf


def _same_noise(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit) -> Mask:
    """Return the samples (N,) that can be compared with the nominal noise, if effects do not change the noise itself.

    On the edge of a line, the noise of the pose is large noise of a reading. If an effect moves the edge, a residual of
    one sigma may be many sigmas of the nominal noise.
    """
    same = np.ones(len(fit.z), dtype=bool)
    if any(is_of_noise(fit, effect) for effect in fit.hypothesis.effects):
        return same
    for place in evidence.places:
        ratio = fit.sd[place] / nominal.sd[place]
        inside = ratio[evidence.fit[place]]
        if len(inside):
            same[place] = np.abs(np.log(ratio / np.median(inside))) < np.log(MAX_NOISE_RATIO)
    return same


def _moments(times_s: Array) -> list[float]:
    """Return the times at which something may have changed, with enough rows on either side."""
    if not len(times_s):
        return []
    moments = np.unique(np.quantile(times_s, np.linspace(0.0, 1.0, MOMENTS + 2)[1:-1])).tolist()
    return [t for t in moments if MIN_ROWS <= np.count_nonzero(times_s >= t) <= len(times_s) - MIN_ROWS]


def _along(quantity: Observed, rows: Mask) -> tuple[int, Covariate]:
    """Return the first covariate that is time or changed monotonically with it, and its rank."""
    named = {covariate.name: covariate for covariate in quantity.covariates}
    time = next(named[name] for name in TIMES if name in named)
    order = np.argsort(time.values[rows], kind="stable")
    for rank, covariate in enumerate(quantity.covariates):
        steps = np.diff(covariate.values[rows][order])
        if covariate is time or (
            covariate.shape is CovariateShape.SMOOTH and (np.all(steps > 0.0) or np.all(steps < 0.0))
        ):
            return rank, covariate
    raise AssertionError("time is a covariate")


def _time_s(evidence: Evidence) -> Array:
    """Return the time of each sample, (N,); NaN if a quantity has none."""
    times = []
    for quantity in evidence.observed:
        named = {covariate.name: covariate.values for covariate in quantity.covariates}
        times.append(next((named[name] for name in TIMES if name in named), np.full(len(quantity.values), np.nan)))
    return np.concatenate(times)


def _jump(evidence: Evidence, nominal: HypothesisFit, after: Mask) -> Array:
    """Return the columns of a jump, (N, 3 per quantity), in sigmas."""
    mean = evidence.values - nominal.z * nominal.sd
    mean = np.where(np.isfinite(mean), mean, 0.0)
    columns = []
    for place in evidence.places:
        inside = np.zeros(len(mean))
        inside[place] = after[place]
        columns += [inside / nominal.sd, inside * np.sign(mean) / nominal.sd, inside * mean / nominal.sd]
    return np.stack(columns, axis=1)
