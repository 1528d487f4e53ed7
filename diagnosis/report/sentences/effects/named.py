"""A named effect in sentences: its numbers, its meaning, and how certain its name is."""

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, inf, log10

from configs.effects.base import Effect
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.profile import Interval
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.unexplained.drift.random_drift import RandomDrift
from diagnosis.report.sentences.quantities import confidence, cost, listed, meaning, percent, with_error

_NEARLY_AS_WELL = 12.0
"""Rise of the cost up to which something else has a twentieth of the weight of a name."""
_MIN_SURE = 0.9
"""Confidence of an effect without rivals, below which chance is mentioned."""


def effect_sentences(diagnosis: Diagnosis) -> list[str]:
    """Return the name, the parameters, the meaning and the possible causes of each effect."""
    sentences = [_sentence(n.effect.name, n.effect.kind, n.values, n.std) for n in diagnosis.named]
    if diagnosis.random_drift is not None:
        sentences.append(random_drift_sentence(diagnosis.random_drift))
    return sentences


def random_drift_sentence(random_drift: RandomDrift) -> str:
    """Return what is known of the slow error of a range sensor."""
    effect = random_drift.effect
    sentence = _sentence(effect.name, type(effect), effect.model_dump(), random_drift.std)
    return f"{sentence} It is random and in no prediction, so the errors on held-out rows and the residuals include it."


def _sentence(label: str, kind: type[Effect], values: Mapping[str, float], std: Mapping[str, float]) -> str:
    parameters = []
    for name, value in values.items():
        unit = kind.parameters()[name].unit
        parameters.append(f"{name} = {with_error(value, std[name])}{'' if unit == '1' else f' {unit}'}")
    return f"{label}: {', '.join(parameters)}. {meaning(kind)} Possible causes: {kind.cause}."


def certainty(named: NamedEffect) -> str:
    """Return how sure the name is, and compared with which other effects."""
    comparison = named.comparison
    sure = confidence(comparison.confidence)
    if comparison.ambiguous_with:
        return f"{sure}; these data cannot distinguish it from {listed(comparison.ambiguous_with)}"
    if comparison.confidence < _MIN_SURE:
        if not comparison.is_whole:
            return f"{sure}; what stays unexplained, or scatters more than stated, may have the same cause"
        other, rise = min(comparison.others, key=lambda each: each[1], default=("", inf))
        if rise < _NEARLY_AS_WELL and all(rise <= rival.worse for rival in comparison.rivals):
            return f"{sure}; {other} would explain the data nearly as well"
        if shares := list(_shares_of_doubt(named)):
            return f"{sure}; the rest is shared by {listed([*shares, 'causes that are in no list'])}"
    if comparison.rivals:
        rival = comparison.rivals[0]
        worse = f"explains the data worse: the cost is higher by {cost(rival.worse)}"
        return f"{sure}; the closest alternative, {rival.effect.name}, {worse}"
    if comparison.confidence < _MIN_SURE:
        return f"{sure}; no other effect comes close, but the cost falls little more than by chance"
    return f"{sure}; no other effect comes close"


def _shares_of_doubt(named: NamedEffect) -> Iterator[str]:
    """Yield what has a notable weight beside a name, the largest first."""
    comparison = named.comparison
    shares = [(comparison.by_chance, "chance (the cost falls little more than a name needs)")]
    if comparison.rivals:
        rival = comparison.rivals[0]
        text = f"the closest alternative ({rival.effect.name}, with which the cost is higher by {cost(rival.worse)})"
        shares.append((rival.worse, text))
    shares += [(rise, name.rstrip(",")) for name, rise in comparison.others[:1]]
    yield from (text for rise, text in sorted(shares) if rise < _NEARLY_AS_WELL)


def to_measure(named: NamedEffect) -> Iterator[tuple[str, str]]:
    """Yield an ambiguous effect and its alternatives, each with the data in which it shows."""
    ambiguous = named.comparison.ambiguous_with
    if ambiguous:
        alternatives = [rival.effect for rival in named.comparison.rivals if rival.effect.name in ambiguous]
        for effect in (named.effect, *alternatives):
            yield effect.name, effect.kind.excitation


def interval_text(intervals: Sequence[Interval]) -> str:
    """Return the widest profile interval of a parameter in words."""
    widest = intervals[-1]
    # Enough digits to show the width of an interval that is narrow compared with its ends.
    digits = max(3, 2 + ceil(log10(max(abs(widest.low), abs(widest.high)) / (widest.high - widest.low))))
    ends = f"{widest.low:.{digits}g} to {widest.high:.{digits}g}"
    return f"{percent(widest.level)} profile interval {ends}" + (", open at a bound" if widest.is_open else "")
