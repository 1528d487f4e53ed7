"""Sentences about the effects of a user's own that were tried and are not named."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from configs.effects.base import Effect
from configs.effects.registry import EFFECTS
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.naming.file_numbers import cost_with_file_numbers, file_numbers
from diagnosis.inference.selection.candidates import setups_of
from diagnosis.inference.selection.refusal import refusal
from diagnosis.inference.selection.scan import scan
from diagnosis.report.sentences.effects.file_numbers import unnamed_comparison
from diagnosis.report.sentences.quantities import with_error


@dataclass(frozen=True)
class TriedEffect:
    """An effect of a user's own that is not named."""

    name: str
    """Name of the effect with its choice."""
    text: str
    """Reason why the effect is not named, in words."""
    values: Mapping[str, float] = field(default_factory=dict)
    """Fitted value by number, beside the named effects; empty where the data cannot show the effect."""
    std: Mapping[str, float] = field(default_factory=dict)
    """Standard error by number."""
    drop: float | None = None
    """Fall of the cost; None where the data cannot show the effect."""


def tried_effects(diagnosis: Diagnosis) -> Iterator[TriedEffect]:
    """Yield what is known about each effect of a loaded file, unless the diagnosis names or withholds it."""
    reported = {each.effect.kind.name for each in diagnosis.named} | {each.name for each in diagnosis.withheld}
    reported |= {diagnosis.law.name} if diagnosis.law else set()
    kinds = [file.member for file in EFFECTS.files.values() if file.member.name not in reported]
    for kind in kinds:
        candidates = [effect for effect in diagnosis.candidates.testable if effect.kind is kind]
        if candidates:
            yield _best(diagnosis, candidates)
        else:
            yield TriedEffect(kind.name, _why_not(kind, diagnosis))


def _why_not(kind: type[Effect], diagnosis: Diagnosis) -> str:
    allowed = setups_of(diagnosis.measurement)
    if allowed.isdisjoint(kind.setups):
        here = " and ".join(sorted(f"Setup.{setup.name}" for setup in allowed))
        return f"not tried, since its setups lack {here}"
    predicted = ", ".join(dict.fromkeys(observed.channel for observed in diagnosis.evidence.observed))
    return f"it changes no prediction of these data, which are of {predicted}; it shows in {kind.excitation}"


def _best(diagnosis: Diagnosis, candidates: list[CandidateEffect]) -> TriedEffect:
    """Return the result of the fit with the most promising choice of an effect beside the named effects."""
    evidence, fit = diagnosis.evidence, diagnosis.fit
    prospect = scan(evidence, fit, candidates)[0]
    effect = prospect.effect
    (tried,) = fits(evidence, [(fit.hypothesis.with_effect(effect), prospect.start)])
    values, std = dict(tried.hypothesis.values(effect, tried.x)), tried.std(effect)
    drop = max(0.0, fit.cost - tried.cost)
    numbers = ", ".join(f"{name} {with_error(value, std[name], '+-')}" for name, value in values.items())
    reason = refusal(evidence, fit, tried, effect) or f"the cost falls by {drop:.1f}, and other effects were preferred"
    if stated_numbers := file_numbers(evidence, tried, effect, std):
        stated = ", ".join(f"{number.name} {with_error(number.value, number.std, '+-')}" for number in stated_numbers)
        change = cost_with_file_numbers(evidence, tried, effect) - fit.cost
        numbers += f". Its file has {stated}; {unnamed_comparison(change, stated_numbers)}"
    beside = "beside the named effects, " if diagnosis.named else ""
    return TriedEffect(effect.name, f"not named: {beside}{reason}; {numbers}", values, std, drop)
