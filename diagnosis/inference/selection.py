"""Which effects the data ask for: forward selection with joint refits, then swaps and removals.

At each round every candidate is looked at, the promising are fitted together with all that is in already, and the best
enters if the cost falls by more than THRESHOLD, plus PER_NUMBER for each number beyond the first. The threshold is that
of the greatest fall over the whole library where nothing is hidden (`benchmarks/diagnosis`), not that of one test:
dozens of effects are tried. Afterwards each effect is held against every other in its place, and against its absence,
for what entered first may have stood in for two that came later.

Guards keep an outlier story from becoming a discovery. The fall must come from several samples. The held-out
rows must not contradict it. Wider noise is believed only of a mean without structure. Data cannot vote where more than
half of the fall is the prior relaxing: then a nuisance was bent far out of its tolerance to do the effect's work, in
held-out rows as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.remembered import remembered
from diagnosis.inference.fit import FAR, Fit, fits
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.likelihood import costs_of_residuals
from diagnosis.inference.scan import Prospect, scan
from diagnosis.inference.unexplained.adequacy import adequacy

THRESHOLD = 15.0
PER_NUMBER = 3.0
"""Added to it for each number of an effect beyond the first."""
TOLL = 6.0
"""For each number, when effects are held against each other: the logarithm of some hundreds of rows, as in the Bayesian
information criterion (Schwarz, Ann. Statist. 6 (1978) 461-464)."""
RESCUE = 9.0
"""Fall that is enough where a model is known to be inadequate and the effect makes it adequate."""
MOST = 3
"""Effects in a model; with more, names mean little."""
PROMISING = 4
"""Candidates that are fitted in each round, at least, if they promise anything."""
NEGLIGIBLE = 0.01
"""Share of a plausible visible effect, the start value of its effect, below which it is none: a delay of a millisecond
in a log of 20 rows a second is as likely the difference between two ways of integrating."""
HOPELESS = 4.0
"""Expected fall up to which a fit is not worth its time."""
NEARLY = 0.7
"""Share of the best prospect's fall from which a candidate is fitted too."""
ROWS = 6.0
"""Effective number of samples that a fall must come from; of few data SHARE_OF_ROWS of them."""
SHARE_OF_ROWS = 0.1
CONFIRMED = 8.0
"""Fall of the cost of held-out rows, as of a parameter at 2.8 standard errors, from which few samples are enough."""
FEWEST = 8
"""Samples, below which nothing is named."""
NO_SLOPE = 1e-6
"""Change of the mean in sigmas: what sums in another order differ by."""
NEAR = 0.1
"""Standard errors from the end of its range, from which an amplitude is there: it would go on if it could."""
WORSE = 2.0
"""Rise of the cost of held-out rows that an effect is allowed, in standard deviations of their sum."""


@dataclass(frozen=True)
class Entry:
    """One step of the selection, for whoever asks why."""

    effect: CandidateEffect
    drop: float
    accepted: bool
    reason: str
    """What decided."""


@dataclass(frozen=True)
class Selection:
    nominal: Fit
    """With the nuisances alone."""
    fit: Fit
    """With the effects that entered."""
    entries: tuple[Entry, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects that entered."""
        return tuple(effect.name for effect in self.fit.hypothesis.effects)


def needed(effect: CandidateEffect) -> float:
    """Fall of the cost from which an effect is believed."""
    return THRESHOLD + PER_NUMBER * (len(effect.coordinates) - 1)


def select(
    evidence: Evidence, nominal: Hypothesis, effects: Sequence[CandidateEffect], begin: Selection | None = None
) -> Selection:
    """The hypothesis that the rows of the fit ask for.

    Args:
        evidence: What was observed.
        nominal: Without effects.
        effects: That may enter.
        begin: Of the same rows when they were thought to say less, so that all of it stands.
    """
    (base,) = fits(evidence, [(nominal, nominal.null() if begin is None else begin.nominal.x)])
    fit, entries = base, []
    if begin is not None and begin.names:
        (fit,) = fits(evidence, [(begin.fit.hypothesis, begin.fit.x)])
        entries = list(begin.entries)
    while len(fit.hypothesis.effects) < MOST:
        found, tried = _entered(evidence, fit, effects)
        entries += tried
        if found is None:
            break
        fit = _pruned(evidence, _swapped(evidence, found, effects))
        if fit.cost >= base.cost or len(fit.hypothesis.effects) == 0:
            break
    return Selection(base, fit, tuple(entries))


def _entered(evidence: Evidence, fit: Fit, effects: Sequence[CandidateEffect]) -> tuple[Fit | None, list[Entry]]:
    """The fit with the best effect more, if any is believed."""
    names = {effect.kind.name for effect in fit.hypothesis.effects}
    prospects = _looked_at(evidence, fit, tuple(effect for effect in effects if effect.kind.name not in names))
    entries: list[Entry] = []
    for tried in ranked(_fitted(evidence, fit, promising(prospects), fit.cost - RESCUE), effects):
        (effect,) = (e for e in tried.hypothesis.effects if e not in fit.hypothesis.effects)
        drop = fit.cost - tried.cost
        reason = refusal(evidence, fit, tried, effect)
        entries.append(Entry(effect, drop, not reason, reason or f"the cost falls by {drop:.1f}"))
        if not reason:
            return tried, entries
        if drop < needed(effect):
            break
    return None, entries


def rescued(evidence: Evidence, fit: Fit, effects: Sequence[CandidateEffect]) -> Fit | None:
    """With an effect more that makes an inadequate model adequate, though it is not believed by itself.

    That something is wrong is known by then, and but one of many reasons is asked for, not whether there is any.
    """
    names = {effect.kind.name for effect in fit.hypothesis.effects}
    if len(names) == MOST:
        return None
    prospects = _looked_at(evidence, fit, tuple(e for e in effects if e.kind.name not in names))
    for tried in ranked(_fitted(evidence, fit, promising(prospects), fit.cost - RESCUE), effects):
        (effect,) = (e for e in tried.hypothesis.effects if e not in fit.hypothesis.effects)
        if refusal(evidence, fit, tried, effect, RESCUE + PER_NUMBER * (len(effect.coordinates) - 1)):
            continue
        if adequacy(evidence, tried).is_adequate:
            return tried
    return None


def promising(prospects: Sequence[Prospect]) -> tuple[Prospect, ...]:
    """Those worth a fit; prospects come best first."""
    if not prospects:
        return ()
    worth = NEARLY * prospects[0].drop
    return tuple(p for k, p in enumerate(prospects) if p.drop > HOPELESS and (k < PROMISING or p.drop >= worth))


@remembered
def _looked_at(evidence: Evidence, fit: Fit, effects: tuple[CandidateEffect, ...]) -> tuple[Prospect, ...]:
    return tuple(scan(evidence, fit, effects))


@remembered
def _fitted(evidence: Evidence, fit: Fit, prospects: tuple[Prospect, ...], goal: float) -> list[Fit]:
    return fits(evidence, [(fit.hypothesis.with_effect(p.effect), p.start) for p in prospects], goal)


def ranked(found: Sequence[Fit], effects: Sequence[CandidateEffect]) -> list[Fit]:
    """Fits by their cost and their numbers; of those that are alike the effect that comes first in the library."""
    order = {effect: k for k, effect in enumerate(effects)}
    last = [max(order.get(effect, -1) for effect in fit.hypothesis.effects) for fit in found]
    return [
        fit
        for _, _, fit in sorted(
            ((round(f.cost + _toll(f), 1), k, f) for k, f in zip(last, found, strict=True)), key=lambda of: of[:2]
        )
    ]


def _toll(fit: Fit) -> float:
    return sum(TOLL * len(effect.coordinates) for effect in fit.hypothesis.effects)


def refusal(evidence: Evidence, before: Fit, after: Fit, effect: CandidateEffect, least: float | None = None) -> str:
    """Why an effect is not believed; empty if it is. `least` is the fall that is needed, by default the usual."""
    drop, least = before.cost - after.cost, needed(effect) if least is None else least
    if drop < least:
        return f"the cost falls by {drop:.1f}, and {least:.0f} are needed"
    if is_negligible(after, effect):
        return "the effect is smaller than a simulation in steps resolves"
    if is_at_bound(after, effect):
        return "it would have to be larger than it can be"
    if pushed := [e.name for e in before.hypothesis.effects if is_at_bound(after, e) and not is_at_bound(before, e)]:
        return f"{pushed[0]} would then have to be larger than it can be"
    was, now = (costs_of_residuals(evidence, of.z, of.sd) for of in (before, after))
    falls = was - now
    of_fit = np.maximum(falls[evidence.fit], 0.0)
    if np.count_nonzero(evidence.fit) < FEWEST:
        return f"fewer than {FEWEST} samples"
    from_prior = before.prior_cost - after.prior_cost
    if from_prior > 0.5 * drop:
        return ""
    if is_of_noise(after, effect) and not adequacy(evidence, before).is_adequate:
        return "structure of the mean comes before the noise"
    of_heldout = falls[evidence.heldout]
    rise = -float(of_heldout.sum())
    rows = float(of_fit.sum() ** 2 / max(float((of_fit**2).sum()), 1e-300))
    # What rows confirm that chose and fitted nothing is no matter of an outlier.
    if rows < min(ROWS, SHARE_OF_ROWS * np.count_nonzero(evidence.fit)) and rise > -CONFIRMED:
        return f"the fall of {drop:.1f} comes from {rows:.1f} samples"
    if rise > WORSE * float(np.sqrt((of_heldout**2).sum())):
        return f"the held-out rows are explained worse, by {rise:.1f}"
    return ""


def is_negligible(fit: Fit, effect: CandidateEffect) -> bool:
    """Whether all its amplitudes are, beside a plausible visible effect."""
    at = fit.x[fit.hypothesis.parameters(effect)].tolist()
    sizes = [
        abs(x - c.null) / abs(c.start - c.null)
        for x, c in zip(at, effect.coordinates, strict=True)
        if c.null is not None
    ]
    return all(size < NEGLIGIBLE for size in sizes)


def is_at_bound(fit: Fit, effect: CandidateEffect) -> bool:
    """Whether an amplitude lies at the end of its range, as where an effect does another's work."""
    places = fit.hypothesis.parameters(effect)
    errors = np.sqrt(np.diag(fit.covariance)[places])
    near = np.where(np.isfinite(errors), NEAR * errors, 0.0).tolist()
    for x, c, by in zip(fit.x[places].tolist(), effect.coordinates, near, strict=True):
        if c.null is not None and not c.is_ceiling and (x + by >= c.high > c.null or x - by <= c.low < c.null):
            return True
    return False


def is_of_noise(fit: Fit, effect: CandidateEffect) -> bool:
    """Whether an effect changes the noise alone."""
    return float(np.abs(fit.slopes[fit.hypothesis.parameters(effect)]).max()) < NO_SLOPE


@remembered
def without(evidence: Evidence, fit: Fit, effect: CandidateEffect) -> Fit:
    """The fit of all but one effect."""
    fewer = fit.hypothesis.without(effect)
    (base,) = fits(evidence, [(fewer, moved(fit.x, fit.hypothesis, fewer))], fit.cost + FAR)
    return base


def replaced(
    evidence: Evidence, fit: Fit, effect: CandidateEffect, base: Fit, effects: Sequence[CandidateEffect]
) -> list[Fit]:
    """Fits with each of the other promising candidates in the place of one effect, the best first.

    Args:
        evidence: What was observed.
        fit: With the effect.
        effect: That is to be replaced.
        base: The fit without it.
        effects: All candidates.
    """
    others = [e for e in fit.hypothesis.effects if e != effect]
    names = {e.kind.name for e in others}
    # Noise may stand in for any structure of the mean, and is no rival of what explains that.
    if not is_of_noise(fit, effect):
        effects = [e for e in effects if e.kind.slot is not Slot.RANGE_NOISE]
    prospects = _looked_at(evidence, base, tuple(e for e in effects if e.kind.name not in names and e != effect))
    return ranked(_fitted(evidence, base, promising(prospects), fit.cost + FAR), effects)


def _swapped(evidence: Evidence, fit: Fit, effects: Sequence[CandidateEffect]) -> Fit:
    """With each effect replaced by another that explains more."""
    if len(fit.hypothesis.effects) < 2:
        return fit
    for effect in fit.hypothesis.effects[:-1]:
        base = without(evidence, fit, effect)
        for rival in replaced(evidence, fit, effect, base, effects):
            if rival.cost + _toll(rival) >= fit.cost + _toll(fit):
                break
            (other,) = (e for e in rival.hypothesis.effects if e not in base.hypothesis.effects)
            if not refusal(evidence, base, rival, other):
                fit = rival
                break
    return fit


def _pruned(evidence: Evidence, fit: Fit) -> Fit:
    """Without the effects whose absence costs too little."""
    while len(fit.hypothesis.effects) > 1:
        found = [without(evidence, fit, effect) for effect in fit.hypothesis.effects]
        rises = [of.cost - fit.cost - needed(effect) for of, effect in zip(found, fit.hypothesis.effects, strict=True)]
        worst = int(np.argmin(rises))
        if rises[worst] >= 0.0:
            break
        fit = found[worst]
    return fit
