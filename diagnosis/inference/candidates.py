"""Which effects can be the cause: every registered term that changes what is measured here, with each of its choices.

The list lives in the registries alone. What acts is found by trying: a term whose start values change no prediction of
these data can neither be found nor excluded by them, and is said to be untestable.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from configs.schema.effects import drive, motor, range_bench
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.hypothesis import Effect, Hypothesis
from diagnosis.measured.measurement import Kind, Measurement
from physics.effects import PHYSICS_TERMS
from physics.effects.base import Slot, Term
from sensors.effects import SENSOR_TERMS

FAMILIES = {
    Kind.MOTOR_STEADY: (motor.__name__,),
    Kind.MOTOR_STEP: (motor.__name__,),
    Kind.TOF_BENCH: (range_bench.__name__,),
    Kind.DRIVE_LOG: (motor.__name__, drive.__name__),
}
"""Which parts of the schema of terms are about a kind of measurement. A drive's ranges have effects of their own, by
sensor; those of the bench would be the same under another name. Play in the gears acts on the bench alone."""
VISIBLE = 1e-3
"""Sigmas by which a prediction must move, at the start values, for an effect to be testable."""


@dataclass(frozen=True)
class Candidates:
    testable: tuple[Effect, ...]
    untestable: tuple[str, ...]
    """Names of effects that these data cannot show."""


def candidates(measurement: Measurement, evidence: Evidence, hypothesis: Hypothesis) -> Candidates:
    """Of the measurement, beside the nuisances of a hypothesis without effects."""
    effects = tuple(
        Effect(term, choices)
        for term in (*PHYSICS_TERMS, *SENSOR_TERMS)
        if term.parameters.__module__ in FAMILIES[measurement.kind]
        if not (measurement.kind is Kind.DRIVE_LOG and term.slot is Slot.GEARBOX)
        for choices in _choices(term, measurement)
    )
    nominal = evidence.of(hypothesis.robots(hypothesis.null()[None]))
    robots = []
    for effect in effects:
        having = hypothesis.with_effect(effect)
        x = np.array([c.start for c in having.coordinates])
        robots += having.robots(x[None])
    found = evidence.of(robots)
    moves = np.abs(found.mean - nominal.mean).max(axis=1, initial=0.0, where=evidence.fit) if effects else []
    moves = np.abs((found.mean - nominal.mean) / evidence.sd)[:, evidence.fit].max(axis=1, initial=0.0)
    spreads = np.abs(np.log(found.sd / nominal.sd))[:, evidence.fit].max(axis=1, initial=0.0)
    seen = (moves > VISIBLE) | (spreads > VISIBLE)
    names = [effect.name for effect in effects]
    return Candidates(
        tuple(effect for effect, is_seen in zip(effects, seen.tolist(), strict=True) if is_seen),
        tuple(name for name, is_seen in zip(names, seen.tolist(), strict=True) if not is_seen),
    )


def _choices(term: Term, measurement: Measurement) -> Iterator[tuple[tuple[str, str], ...]]:
    """Every combination of discrete parameters; where any name goes, those that the rows name."""
    names = list(term.options)
    values = [term.options[name] or _named(name, measurement) for name in names]
    for chosen in product(*values):
        yield tuple(zip(names, chosen, strict=True))


def _named(label: str, measurement: Measurement) -> tuple[str, ...]:
    found = {value for trial in measurement.trials for of in trial.labels if of.name == label for value in of.values}
    return tuple(sorted(found - {""}))
