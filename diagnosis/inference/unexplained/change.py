"""Did something change at one moment, and the named effects only stand in for it?

A screw that comes loose or a sensor that is bumped shifts all that follows. Named effects, two or three of them, can
mimic that so well that hardly any structure remains along time. So the nominal model with a jump competes with them:
from symolo.core.arrays import Array
from one moment on each quantity may be off by a constant, by a constant against its sign, and by a share of itself
(Chow, Econometrica 28 (1960) 591-605, the moment searched for). So may one of the named effects be there from that
moment on only. If that explains the same rows better, numbers counted, and leaves nothing, what was named is withdrawn.
"""

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit
from diagnosis.inference.likelihood import robust_weight
from diagnosis.inference.projection import beyond, orthonormal
from diagnosis.inference.selection import TOLL, is_of_noise
from diagnosis.inference.unexplained.adequacy import Structure, adequacy, change_by
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape, Observed
from symolo.core.arrays import Array

TIMES = ("session_time_s", "t_s")
"""Covariates of the time since a measurement began; of those that a stage has, the first."""
MOMENTS = 40
"""Tried, at quantiles of the rows."""
OF_MOMENT = 2
"""Numbers that the moment counts for, since the best of MOMENTS is taken."""
MIN_ROWS = 5
"""On either side of a moment."""


def change_in_time(evidence: Evidence, nominal: Fit, fit: Fit) -> Structure | None:
    """A jump that explains more than the effects of a fit; None where there is none, or nothing is named."""
    if not fit.hypothesis.effects:
        return None
    root = np.where(evidence.fit, np.sqrt(evidence.weight * robust_weight(fit.z)), 0.0)
    left = fit.left(fit.z * fit.sd / nominal.sd, root)
    numbers = fit.hypothesis.size - nominal.hypothesis.size
    # Both are compared by the nominal noise, but where another noise is named the rows are worth what that leaves them.
    changes_noise = any(is_of_noise(fit, effect) for effect in fit.hypothesis.effects)
    level = float(left @ left) / np.count_nonzero(root) if changes_noise else 1.0
    named = float(left @ left) / level
    basis = orthonormal(nominal.tangents(root))
    residual = nominal.left(nominal.z, root)
    residual = residual - basis @ (basis.T @ residual)
    changes = [change_by(evidence, nominal, fit, e) for e in fit.hypothesis.effects if not is_of_noise(fit, e)]
    best: tuple[float, float, Array] | None = None
    time = _time_s(evidence)
    for moment in _moments(time[evidence.fit & np.isfinite(time)]):
        after = time >= moment
        for columns in (_jump(evidence, nominal, after), *((change * after)[:, None] for change in changes)):
            weighed = columns * root[:, None]
            combined = beyond(weighed, basis[: len(root)].T @ weighed)
            along = combined.T @ (weighed.T @ residual[: len(root)])
            toll = TOLL * (combined.shape[1] + OF_MOMENT)
            squares = float(residual @ residual - along @ along) / level + toll
            if best is None or squares < best[0]:
                best = squares, moment, columns
    if best is None or best[0] >= named + TOLL * numbers:
        return None
    squares, moment, columns = best
    if not adequacy(evidence, nominal, columns).is_adequate:
        return None
    fallen = [float(((root * nominal.z)[place] ** 2).sum()) for place in evidence.places]
    most = evidence.observed[int(np.argmax(fallen))]
    rank, covariate = _along(most, evidence.fit[evidence.places[evidence.observed.index(most)]])
    return Structure(
        observed=most.name,
        channel=most.channel,
        covariate=covariate.name,
        what=f"jump at {moment:.4g} s",
        p=0.0,
        explainable=named - squares + TOLL * (numbers + columns.shape[1]),
        rank=rank,
        basis=columns,
    )


def _moments(given: Array) -> list[float]:
    """Times at which something may have changed, with enough rows on either side."""
    if not len(given):
        return []
    tried = np.unique(np.quantile(given, np.linspace(0.0, 1.0, MOMENTS + 2)[1:-1])).tolist()
    return [t for t in tried if MIN_ROWS <= np.count_nonzero(given >= t) <= len(given) - MIN_ROWS]


def _along(quantity: Observed, rows: Mask) -> tuple[int, Covariate]:
    """Time and its rank, or the first covariate that went one way all the time, for which the same can be said."""
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
    """(N,), NaN where a quantity has none."""
    found = []
    for quantity in evidence.observed:
        named = {covariate.name: covariate.values for covariate in quantity.covariates}
        found.append(next((named[name] for name in TIMES if name in named), np.full(len(quantity.values), np.nan)))
    return np.concatenate(found)


def _jump(evidence: Evidence, nominal: Fit, after: Mask) -> Array:
    """Columns (N, 3 per quantity), in sigmas."""
    mean = evidence.values - nominal.z * nominal.sd
    mean = np.where(np.isfinite(mean), mean, 0.0)
    columns = []
    for place in evidence.places:
        inside = np.zeros(len(mean))
        inside[place] = after[place]
        columns += [inside / nominal.sd, inside * np.sign(mean) / nominal.sd, inside * mean / nominal.sd]
    return np.stack(columns, axis=1)
