"""Another choice of effects where the selected ones leave structure that they do not explain.

The selection fits what its scan expects to explain most. Structure says that this was not all: an effect may be missing
that is too weak to be accepted by itself, or one of the selected effects stands for another one, whose change the scan
did not foresee since it is far from a straight line, or which explains the rows as well and leaves no structure.
"""

from collections.abc import Sequence
from dataclasses import replace

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.penalty import parameter_penalty
from diagnosis.inference.selection.refusal import refusal
from diagnosis.inference.selection.removal import without
from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.inference.selection.stepwise import (
    BEAM,
    HOPELESS,
    MAX_EFFECTS,
    RESCUE,
    Entry,
    Selection,
    extended,
    fitted,
    grown,
    ranked,
    scanned,
)
from diagnosis.inference.unexplained.adequacy import adequacy


def rescued(evidence: Evidence, selection: Selection, effects: Sequence[CandidateEffect]) -> Selection | None:
    """Return an adequate selection in the place of an inadequate one; None if there is none."""
    return _with_one_more(evidence, selection, effects) or _with_another(evidence, selection, effects)


def _with_one_more(evidence: Evidence, selection: Selection, effects: Sequence[CandidateEffect]) -> Selection | None:
    """Return the selection with an additional effect that leaves no structure; None if there is none.

    The effect may be too weak to be accepted by itself: here it is known that something is wrong, and only the cause is
    open.
    """
    fit = selection.fit
    # A third effect that is too weak for itself would make nearly any model adequate.
    if len(fit.hypothesis.effects) >= MAX_EFFECTS - 1:
        return None
    for tried in extended(evidence, fit, effects):
        effect = tried.hypothesis.added_to(fit.hypothesis)
        if not refusal(evidence, fit, tried, effect, RESCUE) and adequacy(evidence, tried).is_adequate:
            drop = fit.cost - tried.cost
            entry = Entry(effect, drop, accepted=True, reason=f"the cost falls by {drop:.1f}, and no structure remains")
            return replace(selection, fit=tried, entries=(*selection.entries, entry))
    return None


def _with_another(evidence: Evidence, selection: Selection, effects: Sequence[CandidateEffect]) -> Selection | None:
    """Return an adequate selection with another effect in the place of one, or of none; None if there is none.

    More effects are fitted than those that the scan expects to be the best. One that explains more may need a further
    effect; one that explains as much must leave no structure by itself.
    """
    fit = selection.fit
    for base in [without(evidence, fit, effect) for effect in fit.hypothesis.effects] or [fit]:
        for rival in _beside(evidence, fit, base, effects):
            behind = rival.cost + parameter_penalty(rival) - fit.cost - parameter_penalty(fit)
            if behind >= AS_GOOD:
                break
            effect = rival.hypothesis.added_to(base.hypothesis)
            if refusal(evidence, base, rival, effect):
                continue
            larger, tried = grown(evidence, selection.nominal, rival, effects) if behind < 0.0 else (rival, [])
            if adequacy(evidence, larger).is_adequate:
                drop = base.cost - rival.cost
                reason = f"the cost falls by {drop:.1f}, where the effects before left structure"
                others = [entry for entry in selection.entries if entry.effect in base.hypothesis.effects]
                entries = (*others, Entry(effect, drop, accepted=True, reason=reason), *tried)
                return replace(selection, fit=larger, entries=entries)
    return None


def _beside(
    evidence: Evidence, fit: HypothesisFit, base: HypothesisFit, effects: Sequence[CandidateEffect]
) -> list[HypothesisFit]:
    """Return the fits of likely effects that a fit lacks, beside those of a smaller one, the best first."""
    names = {effect.kind.name for effect in fit.hypothesis.effects}
    prospects = scanned(evidence, base, [effect for effect in effects if effect.kind.name not in names])
    best = tuple(prospect for prospect in prospects[:BEAM] if prospect.drop > HOPELESS)
    return ranked(fitted(evidence, base, best, fit.cost), effects)
