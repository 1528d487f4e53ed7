"""Selection of the effects that the data need: forward selection with joint refits, then swaps and removals.

In each round every candidate is scanned, the promising ones are fitted together with the effects selected so far, and
the best enters if the cost falls by more than THRESHOLD, plus PER_PARAMETER for each parameter beyond the first. The
threshold is the largest fall among all effects where nothing is hidden (`benchmarks/diagnosis`), and not that of a
single test, since dozens of effects are tried. The search for pairs (below) tries about six times as many models; no
theory says that the threshold suffices for them, and the evidence is the benches with nothing hidden in the evaluation
(docs/diagnosis_evaluation.md). Afterwards each effect is compared with every other in its place, and
with no effect, because the first effect may have been a substitute for two later ones. The best single effect need not
be one of the best pair, so pairs that begin with each of the best few effects are compared with the result, too, even
if it has three effects (beam search: Russell and Norvig, Artificial Intelligence, 4th ed., section 4.1.3). Two effects
that compensate each other explain little alone, so those that should explain most together are compared as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.memoized import memoized
from diagnosis.inference.fitting.fit import FAR, Contest, HypothesisFit, fits, fits_of_contests
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.selection.penalty import parameter_penalty
from diagnosis.inference.selection.refusal import THRESHOLD, is_of_noise, needed, refusal
from diagnosis.inference.selection.removal import cancelled_by, without, without_effects
from diagnosis.inference.selection.scan import Prospect, scan, scan_beside, scan_pairs
from symolo.core.arrays import Array

RESCUE = 9.0
"""Fall of the cost that is enough if the model is known to be inadequate and the effect makes it adequate."""
MAX_EFFECTS = 3
"""Effects in a model; with more, names mean little."""
THIRD = 12.0
"""Fall of the cost that a third effect needs in addition. Three effects together can imitate nearly any curve, and a
cause that is in no list is more frequent than three causes at once."""
PROMISING = 4
"""Smallest number of candidates that are fitted in each round, if the expected fall of the cost is not hopeless."""
HOPELESS = 4.0
"""Expected fall of the cost up to which a fit is not worth its time."""
NEARLY = 0.7
"""Share of the best expected fall from which another candidate is fitted too; the expectation is that uncertain."""
IMITATES = 3.0
"""Deviation in tolerances from which a nuisance may imitate an effect. Beside the effect it returns into its tolerance,
but often along a bent valley that a fit does not follow to its end, so that fits begin within the tolerances too."""
BEAM = 6
"""Number of single effects from which pairs are searched."""
BEAM_SAMPLES = 2000
"""Largest number of samples with a search for pairs. With few samples several pairs explain much the same; with many,
swaps find the best one, and each fit takes long."""
OTHER_PAIRS = 3
"""Number of pairs that are fitted in the place of two effects with more samples."""


@dataclass(frozen=True)
class Entry:
    """One step of the selection, for the report."""

    effect: CandidateEffect
    drop: float
    """Fall of the cost by the effect."""
    accepted: bool
    reason: str
    """Why the effect was accepted or not."""


@dataclass(frozen=True)
class Selection:
    """Result of the selection."""

    nominal: HypothesisFit
    """The fit with the nuisances alone."""
    fit: HypothesisFit
    """The fit with the selected effects."""
    entries: tuple[Entry, ...]
    pairs: tuple[HypothesisFit, ...] = ()
    """Fits with two effects that were compared with the result."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the selected effects."""
        return tuple(effect.name for effect in self.fit.hypothesis.effects)

    @property
    def refused(self) -> tuple[Entry, ...]:
        """Steps in addition to the selected effects, none of which was accepted."""
        last = max((k for k, entry in enumerate(self.entries) if entry.accepted), default=-1)
        return self.entries[last + 1 :]


def select(
    evidence: Evidence, nominal: Hypothesis, effects: Sequence[CandidateEffect], begin: Selection | None = None
) -> Selection:
    """Select the effects that the rows of the fit need.

    Args:
        evidence: The observations.
        nominal: The hypothesis without effects.
        effects: The effects that may enter.
        begin: An earlier selection from the same rows with smaller weights, whose effects stay.
    """
    base = without_effects(evidence, nominal)
    fit, entries = base, []
    if begin is not None and begin.names:
        (fit,) = fits(evidence, [(begin.fit.hypothesis, begin.fit.x)])
        entries = list(begin.entries)
    fit, tried = grown(evidence, base, fit, effects)
    entries += tried
    pairs: list[HypothesisFit] = []
    if fit.hypothesis.effects:
        is_short = np.count_nonzero(evidence.fit) <= BEAM_SAMPLES
        pairs = _pairs(evidence, base, effects) if is_short else _other_pairs(evidence, base, fit, effects)
        pair = _best_pair(evidence, base, pairs, fit) if pairs else fit
        if pair is not fit:
            # What was tried beside the effects before says nothing about these two, so the report has only their steps.
            fit, tried = grown(evidence, base, pair, effects)
            entries = [*_entries_of(evidence, pair), *tried]
    return Selection(base, fit, tuple(entries), tuple(pairs))


def grown(
    evidence: Evidence, base: HypothesisFit, fit: HypothesisFit, effects: Sequence[CandidateEffect]
) -> tuple[HypothesisFit, list[Entry]]:
    """Return the fit with one effect after the other in addition, until none is accepted, and the steps.

    Args:
        evidence: The observations.
        base: The fit without effects.
        fit: The fit with the effects to begin with.
        effects: The effects that may enter.
    """
    entries: list[Entry] = []
    while len(fit.hypothesis.effects) < MAX_EFFECTS:
        larger, tried = _entered(evidence, fit, effects)
        entries += tried
        if larger is None:
            break
        fit = _pruned(evidence, _swapped(evidence, larger, effects))
        if fit.cost >= base.cost:
            break
    return fit, entries


def _entries_of(evidence: Evidence, pair: HypothesisFit) -> list[Entry]:
    """Return a step for each effect of a pair, with the fall of the cost beside the other one."""
    drops = [(effect, without(evidence, pair, effect).cost - pair.cost) for effect in pair.hypothesis.effects]
    return [
        Entry(effect, drop, accepted=True, reason=f"the cost falls by {drop:.1f} beside the other")
        for effect, drop in drops
    ]


def _pairs(evidence: Evidence, base: HypothesisFit, effects: Sequence[CandidateEffect]) -> list[HypothesisFit]:
    """Return the fits with two effects that begin with one of the best, and those that compensate, the best first.

    Args:
        evidence: The observations.
        base: The fit without effects.
        effects: The effects that may enter.
    """
    prospects = [p for p in scanned(evidence, base, effects) if p.drop > HOPELESS]
    singles = ranked(fitted(evidence, base, tuple(prospects[:BEAM]), base.cost - HOPELESS), effects)
    # Effects that these data cannot distinguish, such as an offset and a bias of the only material, fit equally well.
    distinct = {round(single.cost, 1): single for single in reversed(singles)}
    pairs = _extended_all(evidence, list(distinct.values()), effects)
    tried = {frozenset(pair.hypothesis.effects) for pair in pairs}
    new = [p for p in scan_pairs(evidence, base, effects) if frozenset(p.hypothesis.effects) not in tried]
    # Two effects that are expected to explain hardly more than a single one need no fit.
    min_drop = HOPELESS + (prospects[0].drop if prospects else 0.0)
    together = [(p.hypothesis, p.start) for p in new[:BEAM] if p.drop > min_drop]
    return ranked([*pairs, *fits(evidence, together, base.cost - HOPELESS)], effects)


def _other_pairs(
    evidence: Evidence, base: HypothesisFit, fit: HypothesisFit, effects: Sequence[CandidateEffect]
) -> list[HypothesisFit]:
    """Return fits with two effects in the place of all of a fit, the best first; none with several stages.

    Swaps of one effect miss two factors of the sensors that only together replace two numbers of a motor.
    """
    if len(fit.hypothesis.effects) < 2 or len(evidence.stages) > 1:
        return []
    others = _beside(fit, effects) if len(fit.hypothesis.effects) == 2 else effects
    prospects = scan_pairs(evidence, base, others)[:OTHER_PAIRS]
    return ranked(fits(evidence, [(p.hypothesis, p.start) for p in prospects], fit.cost), effects)


def _best_pair(
    evidence: Evidence, base: HypothesisFit, pairs: Sequence[HypothesisFit], fit: HypothesisFit
) -> HypothesisFit:
    """Return the best pair, if it explains more than a fit with one to three effects; otherwise the fit.

    Args:
        evidence: The observations.
        base: The fit without effects.
        pairs: The fits with two effects.
        fit: The fit with the effects to compare with.
    """
    # Two effects that cancel each other imitate something else, so that any other two come before them.
    rival = base if _cancels(evidence, base, fit) else fit
    names = set(fit.hypothesis.effects)
    # Equal pairs keep their order.
    for pair in sorted(pairs, key=lambda each: round(each.cost + parameter_penalty(each), 1)):
        if (
            set(pair.hypothesis.effects) != names
            and _is_better(pair, rival)
            and all(
                not refusal(evidence, without(evidence, pair, effect), pair, effect)
                for effect in pair.hypothesis.effects
            )
            and not _cancels(evidence, base, pair)
        ):
            return pair
    return fit


def _cancels(evidence: Evidence, base: HypothesisFit, fit: HypothesisFit) -> bool:
    """Return whether two effects of a fit undo each other."""
    return any(cancelled_by(evidence, base, fit, effect) for effect in fit.hypothesis.effects)


def _is_better(pair: HypothesisFit, fit: HypothesisFit) -> bool:
    """Return whether a pair of effects explains more than another pair, or enough for a single effect or three."""
    if len(fit.hypothesis.effects) == 2:
        return pair.cost + parameter_penalty(pair) < fit.cost + parameter_penalty(fit)
    return pair.cost + _needed(pair) < fit.cost + _needed(fit)


def _entered(
    evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]
) -> tuple[HypothesisFit | None, list[Entry]]:
    """Return the fit with the best additional effect, if any is accepted, and the steps."""
    entries: list[Entry] = []
    threshold = THRESHOLD + (THIRD if len(fit.hypothesis.effects) == MAX_EFFECTS - 1 else 0.0)
    for tried in extended(evidence, fit, effects):
        effect = tried.hypothesis.added_to(fit.hypothesis)
        drop = fit.cost - tried.cost
        reason = refusal(evidence, fit, tried, effect, threshold)
        entries.append(Entry(effect, drop, not reason, reason or f"the cost falls by {drop:.1f}"))
        if not reason:
            return tried, entries
        # The candidates come best first, so after one that is too weak hardly any can be strong enough.
        if drop < needed(effect, threshold):
            break
    return None, entries


def extended(evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> list[HypothesisFit]:
    """Return the fits with one promising effect in addition, the best first."""
    prospects = scanned(evidence, fit, _beside(fit, effects))
    return ranked(fitted(evidence, fit, promising(prospects), fit.cost - RESCUE), effects)


def _extended_all(
    evidence: Evidence, several: Sequence[HypothesisFit], effects: Sequence[CandidateEffect]
) -> list[HypothesisFit]:
    """Return the same for several fits one after the other, computed side by side."""
    prospects = scan_beside(evidence, [(fit, _beside(fit, effects)) for fit in several])
    contests = [
        Contest(evidence, _starts(fit, promising(each)), fit.cost - RESCUE)
        for fit, each in zip(several, prospects, strict=True)
    ]
    return [fit for each in fits_of_contests(contests) for fit in ranked(_best_of_each(each), effects)]


def _beside(fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> tuple[CandidateEffect, ...]:
    """Return the effects that a fit lacks."""
    names = {effect.kind.name for effect in fit.hypothesis.effects}
    return tuple(effect for effect in effects if effect.kind.name not in names)


def _starts(fit: HypothesisFit, prospects: Sequence[Prospect]) -> list[tuple[Hypothesis, Array]]:
    """Return the starts of fits with one effect in addition: one of each, or two if nuisances imitate an effect.

    The second start has nuisances of their nominal size. A delay or lag is twice as long there, because it alone has to
    explain what they imitate, and because a fit that starts with too short a delay ends at a minimum between samples.
    """
    starts = [(fit.hypothesis.with_effect(prospect.effect), prospect.start) for prospect in prospects]
    if not starts or np.abs(fit.x[: len(fit.hypothesis.nuisances)]).max(initial=0.0) < IMITATES:
        return starts
    nuisances = len(fit.hypothesis.nuisances)
    for prospect, (h, x) in zip(prospects, tuple(starts), strict=True):
        factor = 2.0 if any(coordinate.is_time for coordinate in prospect.effect.coordinates) else 1.0
        starts.append((h, np.where(np.arange(len(x)) < nuisances, 0.0, h.scaled(prospect.effect, x, factor))))
    return starts


def _best_of_each(several: Sequence[HypothesisFit]) -> list[HypothesisFit]:
    """Return the best fit of each hypothesis."""
    best: dict[tuple[CandidateEffect, ...], HypothesisFit] = {}
    for fit in several:
        effects = fit.hypothesis.effects
        if effects not in best or fit.cost < best[effects].cost:
            best[effects] = fit
    return list(best.values())


def promising(prospects: Sequence[Prospect]) -> tuple[Prospect, ...]:
    """Return the prospects that are worth a fit; `prospects` come best first."""
    return tuple(
        prospect
        for k, prospect in enumerate(prospects)
        if prospect.drop > HOPELESS and (k < PROMISING or prospect.drop >= NEARLY * prospects[0].drop)
    )


def scanned(evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> tuple[Prospect, ...]:
    """Return the prospect of each effect beside a fit, the best first; those that are known are not computed again."""
    known = _known_prospects(evidence, fit)
    new = [effect for effect in effects if effect not in known]
    if new:
        known.update(dict.fromkeys(new))
        known.update({prospect.effect: prospect for prospect in scan(evidence, fit, new)})
    prospects = (known[effect] for effect in effects)
    return tuple(sorted((p for p in prospects if p is not None), key=lambda prospect: -prospect.drop))


@memoized
def _known_prospects(_evidence: Evidence, _fit: HypothesisFit) -> dict[CandidateEffect, Prospect | None]:
    """Return the prospects that are known beside a fit, to which others are added; None for an effect without one."""
    return {}


@memoized
def fitted(evidence: Evidence, fit: HypothesisFit, prospects: tuple[Prospect, ...], goal: float) -> list[HypothesisFit]:
    return _best_of_each(fits(evidence, _starts(fit, prospects), goal))


def ranked(candidates: Sequence[HypothesisFit], effects: Sequence[CandidateEffect]) -> list[HypothesisFit]:
    """Return fits by cost and number of parameters; equal ones by the order of their effects in the library."""
    # The cost is rounded, so that equal fits keep their order on every machine. An effect on everything comes before
    # one on a single material, sensor or side, which is a more special claim.
    general = sorted(effects, key=lambda effect: bool(effect.choices))
    order = {effect: k for k, effect in enumerate(general)}
    last = [max(order.get(effect, -1) for effect in fit.hypothesis.effects) for fit in candidates]
    return [
        fit
        for _, _, fit in sorted(
            ((round(f.cost + parameter_penalty(f), 1), k, f) for k, f in zip(last, candidates, strict=True)),
            key=lambda row: row[:2],
        )
    ]


def _needed(fit: HypothesisFit) -> float:
    return sum(map(needed, fit.hypothesis.effects)) + THIRD * (len(fit.hypothesis.effects) == MAX_EFFECTS)


def replaced(
    evidence: Evidence,
    fit: HypothesisFit,
    effect: CandidateEffect,
    base: HypothesisFit,
    effects: Sequence[CandidateEffect],
) -> list[HypothesisFit]:
    """Return the fits with each of the other promising candidates in place of one effect, the best first.

    Args:
        evidence: The observations.
        fit: The fit with the effect.
        effect: The effect to replace.
        base: The fit without the effect.
        effects: All candidates.
    """
    others = [e for e in fit.hypothesis.effects if e != effect]
    names = {e.kind.name for e in others}
    # Wider noise can replace any structure of the mean, so it is no rival of an effect that explains the structure.
    if not is_of_noise(fit, effect):
        effects = [e for e in effects if e.kind.slot is not Slot.RANGE_NOISE]
    prospects = scanned(evidence, base, [e for e in effects if e.kind.name not in names and e != effect])
    return ranked(fitted(evidence, base, promising(prospects), fit.cost + FAR), effects)


def _swapped(evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> HypothesisFit:
    """Return the fit with each effect replaced by another one, if that explains more."""
    # The last effect has just been chosen as the best beside the others, so only the earlier ones are compared again.
    for effect in fit.hypothesis.effects[:-1]:
        base = without(evidence, fit, effect)
        for rival in replaced(evidence, fit, effect, base, effects):
            if rival.cost + parameter_penalty(rival) >= fit.cost + parameter_penalty(fit):
                break
            if not refusal(evidence, base, rival, rival.hypothesis.added_to(base.hypothesis)):
                fit = rival
                break
    return fit


def _pruned(evidence: Evidence, fit: HypothesisFit) -> HypothesisFit:
    """Return the fit without the effects that lower the cost too little."""
    while len(fit.hypothesis.effects) > 1:
        effects = fit.hypothesis.effects
        refits = [without(evidence, fit, effect) for effect in effects]
        rises = [refit.cost - fit.cost - needed(effect) for refit, effect in zip(refits, effects, strict=True)]
        weakest = int(np.argmin(rises))
        if rises[weakest] >= 0.0:
            break
        fit = refits[weakest]
    return fit
