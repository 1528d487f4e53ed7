"""Which effects can be the cause: every registered effect that changes what is measured, with each of its choices.

The registry is the only list. Which effects act is found by trying: an effect whose start values change no prediction
of these data can neither be found nor excluded by them, and is reported as untestable.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from configs.effects.base import Effect, Setup
from configs.effects.registry import effect_classes
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis
from diagnosis.measured.measurement import Kind, Measurement

SETUPS = {
    Kind.MOTOR_STEADY: Setup.MOTOR_BENCH,
    Kind.MOTOR_STEP: Setup.MOTOR_BENCH,
    Kind.TOF_BENCH: Setup.RANGE_BENCH,
    Kind.DRIVE_LOG: Setup.DRIVE,
}
"""What is measured, by kind of measurement. An effect names the setups in which it is looked for: a drive has range
effects of its own, by sensor, since those of the bench would be the same under another name."""
VISIBLE = 1e-3
"""Sigmas by which a prediction must move, at the start values, for an effect to be testable."""


@dataclass(frozen=True)
class Candidates:
    testable: tuple[CandidateEffect, ...]
    untestable: tuple[str, ...]
    """Names of effects that these data cannot show."""


def candidates(measurement: Measurement, evidence: Evidence, hypothesis: Hypothesis) -> Candidates:
    """Of the measurement, beside the nuisances of a hypothesis without effects."""
    effects = tuple(
        CandidateEffect(effect, choices)
        for effect in effect_classes()
        if SETUPS[measurement.kind] in effect.setups
        for choices in _choices(effect, measurement)
    )
    nominal = evidence.of(hypothesis.robots(hypothesis.null()[None]))
    robots = []
    for effect in effects:
        having = hypothesis.with_effect(effect)
        x = np.array([c.start for c in having.coordinates])
        robots += having.robots(x[None])
    found = evidence.of(robots)
    moves = np.abs((found.mean - nominal.mean) / evidence.sd)[:, evidence.fit].max(axis=1, initial=0.0)
    spreads = np.abs(np.log(found.sd / nominal.sd))[:, evidence.fit].max(axis=1, initial=0.0)
    seen = (moves > VISIBLE) | (spreads > VISIBLE)
    names = [effect.name for effect in effects]
    return Candidates(
        tuple(effect for effect, is_seen in zip(effects, seen.tolist(), strict=True) if is_seen),
        tuple(name for name, is_seen in zip(names, seen.tolist(), strict=True) if not is_seen),
    )


def _choices(effect: type[Effect], measurement: Measurement) -> Iterator[tuple[tuple[str, str], ...]]:
    """Every combination of discrete parameters; where any name goes, those that the rows name."""
    options = effect.options()
    values = [options[name] or _named(name, measurement) for name in options]
    for chosen in product(*values):
        yield tuple(zip(options, chosen, strict=True))


def _named(label: str, measurement: Measurement) -> tuple[str, ...]:
    found = {value for trial in measurement.trials for of in trial.labels if of.name == label for value in of.values}
    return tuple(sorted(found - {""}))
