"""The models that remain after a diagnosis: the named effects, and all others that explain the data as well."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, moved
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.inference.selection.rivals import AS_GOOD, SECOND, relative_weight, rises_over
from symolo.core.errors import InputError

MAX_MODELS = 6
"""Number of models from which the others, which explain the data less well, are left out."""
MIN_HINT = 4.0
"""Fall of the cost from which an effect that is too weak to be named counts as a model."""


@dataclass(frozen=True, eq=False)
class RemainingModel:
    """A set of effects that may be the cause, with all parameters fitted to the old data."""

    name: str
    """Names of its effects, joined with `and`; `no effect` without any."""
    fit: HypothesisFit
    rise: float
    """Increase of the cost over the best model, with a penalty for each parameter."""
    weight: float
    """Probability of the model among those that remain (`diagnosis.inference.selection.rivals.relative_weight`)."""


def remaining_models(diagnosis: Diagnosis) -> tuple[RemainingModel, ...]:
    """Return the models that remain, the named one first.

    Raises:
        InputError: Nothing is named and nothing is near it, or the cause is in no list.
    """
    if diagnosis.random_drift is not None:
        what, cure = "the sensor has a random drift", "measure longer: range_wander is not seen in a short trial"
        raise InputError(what, cure=cure)
    if diagnosis.conclusion == CaseVerdict.UNEXPLAINED:
        unexplained = diagnosis.unexplained
        along = f" of {unexplained.channel} along {unexplained.covariate}" if unexplained else ""
        what = f"the cause is in no list: a structure{along} is unexplained, so that there are no rivals to distinguish"
        raise InputError(what, cure="see report.html, or try an effect of your own with --effects")
    fitted = [(fit, rise) for fit, rise in _fits(diagnosis) if rise < AS_GOOD]
    if not diagnosis.named and len(fitted) < 2:
        what = "nothing was named, and no effect comes near it: the nominal simulation explains the data"
        raise InputError(what, cure="measure at other voltages or distances if you suspect a fault")
    first, *others = fitted
    distinct: dict[frozenset[CandidateEffect], tuple[HypothesisFit, float]] = {}
    for fit, rise in (first, *sorted(others, key=lambda each: each[1])):
        distinct.setdefault(frozenset(fit.hypothesis.effects), (fit, rise))
    models = [*distinct.values()][:MAX_MODELS]
    weights = [relative_weight(max(rise, 0.0)) for _, rise in models]
    return tuple(
        RemainingModel(_name(fit), fit, rise, weight / sum(weights))
        for (fit, rise), weight in zip(models, weights, strict=True)
    )


def _fits(diagnosis: Diagnosis) -> Iterator[tuple[HypothesisFit, float]]:
    """Yield models and the increase of their cost over the named one."""
    best = diagnosis.fit
    yield best, 0.0
    for named in diagnosis.named:
        for rival in named.comparison.rivals:
            yield rival.fit, rival.worse
    if len(diagnosis.named) == 1:
        (named,) = diagnosis.named
        pairs = [
            pair
            for pair in diagnosis.selection.pairs
            if named.effect.kind not in {effect.kind for effect in pair.hypothesis.effects}
        ]
        for pair, rise in zip(pairs, rises_over(diagnosis.evidence, best, pairs), strict=True):
            yield pair, rise + SECOND
    if not diagnosis.named:
        yield from _hints(diagnosis)


def _hints(diagnosis: Diagnosis) -> Iterator[tuple[HypothesisFit, float]]:
    """Yield the fits with one effect that is too weak to be named; as models they count as much as no effect."""
    base, evidence = diagnosis.fit, diagnosis.evidence
    for entry in diagnosis.selection.refused:
        if entry.drop < MIN_HINT:
            continue
        hypothesis = base.hypothesis.with_effect(entry.effect)
        start = moved(base.x, base.hypothesis, hypothesis)
        start[hypothesis.parameters(entry.effect)] = np.array([c.start for c in entry.effect.coordinates])
        (fit,) = fits(evidence, [(hypothesis, start)])
        if base.cost - fit.cost >= MIN_HINT:
            yield fit, 0.0


def _name(fit: HypothesisFit) -> str:
    return " and ".join(effect.name for effect in fit.hypothesis.effects) or "no effect"
