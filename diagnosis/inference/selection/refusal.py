"""Rules that keep an effect out of the model, although the cost falls with it.

Guards keep outliers from being reported as an effect. The fall must come from several samples. The held-out rows must
not contradict it. Wider noise is accepted only if the mean has no structure. The tests on samples and held-out rows are
skipped if more than half of the fall comes from the prior: then a nuisance had left its tolerance and imitated the
effect in those rows too.
"""

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.memoized import memoized
from diagnosis.inference.fitting.coordinate import Coordinate
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.likelihood import costs_of_residuals
from diagnosis.inference.unexplained.adequacy import adequacy
from sensors.effects.range_sensor.noise_scale import NoiseScale
from symolo.core.arrays import Array

THRESHOLD = 15.0
"""Fall of the cost from which an effect with one parameter is accepted."""
THRESHOLD_OF_NOISE = 9.0
"""The same for an effect of the noise, three standard errors. There are two of these and not dozens, so that the
largest fall among them is smaller where nothing is hidden."""
PER_PARAMETER = 3.0
"""Addition to the threshold for each parameter of an effect beyond the first."""
NEGLIGIBLE = 0.01
"""Size relative to the start value, below which an effect does not count in a time series: a delay of a millisecond in
a log with 20 rows per second may as well be an integration error. The rows of a bench are states, without such errors,
so that any size counts there that the readings show, and so does any size of an effect that grows with time."""
NEGLIGIBLE_TIME = 0.01
"""The same for a delay or a lag, relative to the time between two rows, which is less in a fast log: a row is divided
where a delayed voltage takes effect, and a lag acts within the row."""
FAR_BELOW_A_ROW = 0.05
"""Size of a delay or a lag relative to the time between two rows, below which rows at these times hardly show it."""
MIN_ROWS = 6.0
"""Smallest effective number of samples that a fall must come from; with little data, MIN_ROWS_SHARE of the samples."""
MIN_ROWS_SHARE = 0.1
"""Share of the samples of the fit."""
AGREEING = 2.0
"""Smallest number of samples beyond the number of parameters, from which few samples are enough."""
CLEAR = 8.0
"""Change of the cost of the held-out rows, as for a parameter at 2.8 standard errors, from which they confirm an effect
or contradict it. A smaller change says little: rows that hardly show an effect may by chance be predicted a little
better without it. Of 373 right names in cases of the family `wide_a`, none was contradicted by more than 7.9."""
MAX_WORSE = 2.0
"""Rise of the cost of held-out rows in standard deviations of the sum, up to which they do not contradict an effect."""
MIN_SAMPLES = 8
"""Smallest number of samples for naming an effect."""
MIN_SAMPLES_OF_NOISE = 16
"""Smallest number of samples for naming an effect of the noise: in fewer ones, no test could see what else it may
be."""
STATED_WITHIN = 2.0
"""Factor within which a stated noise may be wrong (GAP_FORMAT)."""
NO_SLOPE = 1e-6
"""Change of the mean in sigmas that may be rounding error."""
NEAR = 0.1
"""Distance from a bound in standard errors, up to which an amplitude counts as being at the bound."""


def needed(effect: CandidateEffect, threshold: float = THRESHOLD) -> float:
    """Return the fall of the cost from which an effect is accepted."""
    if effect.kind.slot is Slot.RANGE_NOISE:
        threshold = min(threshold, THRESHOLD_OF_NOISE)
    return threshold + PER_PARAMETER * (len(effect.coordinates) - 1)


def refusal(
    evidence: Evidence,
    before: HypothesisFit,
    after: HypothesisFit,
    effect: CandidateEffect,
    threshold: float = THRESHOLD,
) -> str:
    """Return why an effect is not accepted; empty if it is.

    Args:
        evidence: The observations.
        before: The fit without the effect.
        after: The fit with the effect.
        effect: The effect.
        threshold: Fall of the cost from which an effect with one parameter is accepted.
    """
    drop, min_drop = before.cost - after.cost, needed(effect, threshold)
    if drop < min_drop:
        return f"the cost falls by {max(drop, 0.0):.1f}, and {min_drop:.0f} are needed"
    if is_negligible(after, effect):
        return "the effect is smaller than the integration steps of a simulation resolve"
    if is_at_bound(after, effect):
        return "its size would exceed its bounds"
    if pushed := [e.name for e in before.hypothesis.effects if is_at_bound(after, e) and not is_at_bound(before, e)]:
        return f"the size of {pushed[0]} would then exceed its bounds"
    if np.count_nonzero(evidence.fit) < MIN_SAMPLES:
        return f"fewer than {MIN_SAMPLES} samples"
    # A nuisance had left its tolerance to imitate the effect and now returns. It imitated the effect in all rows, so
    # the samples fall by little, and no count of them says anything against the effect.
    if before.prior_cost - after.prior_cost > 0.5 * drop:
        return ""
    if is_of_noise(after, effect) and (reason := _refusal_of_noise(evidence, before, after, effect)):
        return reason
    return _refusal_by_rows(evidence, before, after, effect, min_drop)


def _refusal_by_rows(
    evidence: Evidence, before: HypothesisFit, after: HypothesisFit, effect: CandidateEffect, min_drop: float
) -> str:
    """Return whether only a few rows show an effect, or held-out rows contradict it; empty if neither is the case."""
    drop, falls = before.cost - after.cost, before.costs - after.costs
    heldout_fall, fit_falls = heldout_falls(evidence, before, after, effect), np.maximum(falls[evidence.fit], 0.0)
    rise = -float(heldout_fall.sum())
    rows = _effective(fit_falls)
    few = rows < min(MIN_ROWS, MIN_ROWS_SHARE * np.count_nonzero(evidence.fit))
    # An effect goes through as many outliers as it has parameters. Two more rows that agree are not there by chance, if
    # they suffice by themselves; nuisances that return into their tolerances count as one of them. And if the held-out
    # rows, which were not used for the fit, confirm the effect, it is not made of outliers either.
    numbers = len(effect.coordinates)
    shown = np.sort(np.append(fit_falls, max(before.prior_cost - after.prior_cost, 0.0)))
    others = float(shown[: len(shown) - numbers].sum())
    agrees = _effective(shown) >= numbers + AGREEING and others >= min_drop
    if few and not agrees and rise > -CLEAR:
        return f"the fall of {drop:.1f} comes from {rows:.1f} samples"
    # Where the noise falls with an effect, a few outliers among the held-out rows cost far more.
    if rise > max(CLEAR, MAX_WORSE * float(np.sqrt((heldout_fall**2).sum()))):
        return f"the cost of the held-out rows rises by {rise:.1f}"
    return ""


def heldout_falls(evidence: Evidence, before: HypothesisFit, after: HypothesisFit, effect: CandidateEffect) -> Array:
    """Return by how much the cost of each held-out row falls with an effect.

    Rows speak against an effect of the mean only if they also do so with the same noise. A worse model has more
    outliers and a higher level, for which an outlier among the held-out rows costs less.
    """
    falls = (before.costs - after.costs)[evidence.heldout]
    if float(falls.sum()) >= 0.0 or is_of_noise(after, effect):
        return falls
    level = (after.noise.levels / before.noise.levels)[evidence.quantity]
    costs = costs_of_residuals(evidence, before.z / level, before.sd * level, after.noise)
    alike = (costs - after.costs)[evidence.heldout]
    return np.zeros_like(falls) if float(alike.sum()) > 0.0 else max(falls, alike, key=lambda each: float(each.sum()))


def _effective(falls: Array) -> float:
    """Return the number of equal falls with the same ratio of sum and sum of squares (Kish)."""
    return float(falls.sum() ** 2 / max(float((falls**2).sum()), 1e-300))


def is_negligible(fit: HypothesisFit, effect: CandidateEffect) -> bool:
    """Return whether all amplitudes of an effect in a time series are negligible compared with its start values.

    Errors of an integration are the same early and late, so that no effect that grows with time is negligible.
    """
    if effect.kind.grows_with_time or not any(observed.is_series for observed in fit.evidence.observed):
        return False
    at = fit.x[fit.hypothesis.parameters(effect)].tolist()
    sizes = [
        (abs(x - c.null), _negligible(fit.evidence, c))
        for x, c in zip(at, effect.coordinates, strict=True)
        if c.null is not None
    ]
    return all(size < negligible for size, negligible in sizes)


def is_far_below_a_row(fit: HypothesisFit, effect: CandidateEffect) -> bool:
    """Return whether an effect is a delay or a lag that is far shorter than the time between two rows."""
    x = fit.x[fit.hypothesis.parameters(effect)].tolist()
    times_s = [
        abs(at - c.null) * c.unit
        for at, c in zip(x, effect.coordinates, strict=True)
        if c.is_time and c.null is not None
    ]
    return bool(times_s) and max(times_s) < FAR_BELOW_A_ROW * _row_s(fit.evidence)


def _negligible(evidence: Evidence, coordinate: Coordinate) -> float:
    """Return the size of an amplitude, as a coordinate, that is negligible in a time series."""
    size = NEGLIGIBLE * abs(coordinate.start - (coordinate.null or 0.0))
    return min(size, NEGLIGIBLE_TIME * _row_s(evidence) / coordinate.unit) if coordinate.is_time else size


@memoized
def _row_s(evidence: Evidence) -> float:
    """Return the usual time between two rows of a time series."""
    steps_s = [
        float(np.median(np.diff(observed.t_s)[np.diff(observed.trial) == 0]))
        for observed in evidence.observed
        if observed.is_series and np.any(np.diff(observed.trial) == 0)
    ]
    return min(steps_s, default=np.inf)


def is_at_bound(fit: HypothesisFit, effect: CandidateEffect) -> bool:
    """Return whether an amplitude or a shape is at its bound, as if the effect imitates another one."""
    places = fit.hypothesis.parameters(effect)
    errors = np.sqrt(np.diag(fit.covariance)[places])
    margins = np.where(np.isfinite(errors), NEAR * errors, 0.0).tolist()
    for x, c, margin in zip(fit.x[places].tolist(), effect.coordinates, margins, strict=True):
        # A shape may be near a bound because the data hardly determine it, so only the bound itself counts.
        if c.null is None and not c.is_ceiling and (x >= c.high or x <= c.low):
            return True
        if c.null is not None and not c.is_ceiling and (x + margin >= c.high > c.null or x - margin <= c.low < c.null):
            return True
    return False


def _refusal_of_noise(evidence: Evidence, before: HypothesisFit, after: HypothesisFit, effect: CandidateEffect) -> str:
    """Return why an effect of the noise is not accepted; empty if it is."""
    if np.count_nonzero(evidence.fit) < MIN_SAMPLES_OF_NOISE:
        return f"with fewer than {MIN_SAMPLES_OF_NOISE} samples, noise looks like an error of any other kind"
    if is_within_statement(after, effect):
        return "the noise may be as large as stated, within a factor of two"
    if adequacy(evidence, before).has_cause:
        return "the mean has structure, which must be explained before the noise"
    return ""


def is_within_statement(fit: HypothesisFit, effect: CandidateEffect) -> bool:
    """Return whether a factor on the noise is not clearly beyond that by which a statement may be wrong."""
    if effect.kind is not NoiseScale:
        return False
    place = fit.hypothesis.parameters(effect).start
    change = float(fit.x[place] - fit.hypothesis.null()[place])
    # A fit without the effect has a level as large as a statement allows, but none as small (`LEVELS`). So the fall of
    # the cost is one over the statement for more noise only, and for less noise its size here must be as significant.
    errors = 2.0 if change > 0.0 else float(np.sqrt(THRESHOLD_OF_NOISE))
    return abs(change) - errors * float(np.sqrt(fit.covariance[place, place])) < float(np.log(STATED_WITHIN))


def is_of_noise(fit: HypothesisFit, effect: CandidateEffect) -> bool:
    """Return whether an effect changes only the noise."""
    return float(np.abs(fit.slopes[fit.hypothesis.parameters(effect)]).max()) < NO_SLOPE
