"""Candidate effects: every registered effect that changes the predictions of a measurement, with each of its choices.

The registries are the only list of effects. Whether an effect matters is found by trying it: if its start values change
no prediction of the data, the data can neither show nor exclude it, and it is reported as untestable.
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
"""Modules of the schema whose effects apply to each kind of measurement. The range sensors of a drive have effects of
their own, by sensor; those of the bench would be the same under another name. Gear play applies to the bench only."""
VISIBLE = 1e-3
"""Change of a prediction in sigmas, at the start values, from which an effect is testable."""


@dataclass(frozen=True)
class Candidates:
    """The effects that may explain a measurement."""

    testable: tuple[Effect, ...]
    untestable: tuple[str, ...]
    """Names of effects that the data cannot show."""


def candidates(measurement: Measurement, evidence: Evidence, hypothesis: Hypothesis) -> Candidates:
    """Return the candidate effects of a measurement; `hypothesis` has the nuisances and no effects."""
    effects = [
        Effect(term, choices)
        for term in (*PHYSICS_TERMS, *SENSOR_TERMS)
        if term.parameters.__module__ in FAMILIES[measurement.kind]
        if not (measurement.kind is Kind.DRIVE_LOG and term.slot is Slot.GEARBOX)
        for choices in _choices(term, measurement)
    ]
    robots = [hypothesis.robot(hypothesis.null())]
    for effect in effects:
        extended = hypothesis.with_effect(effect)
        robots.append(extended.robot(np.array([c.start for c in extended.coordinates])))
    prediction = evidence.of(robots)
    moves = np.abs((prediction.mean[1:] - prediction.mean[:1]) / evidence.sd)[:, evidence.fit].max(axis=1, initial=0.0)
    spreads = np.abs(np.log(prediction.sd[1:] / prediction.sd[:1]))[:, evidence.fit].max(axis=1, initial=0.0)
    visible = ((moves > VISIBLE) | (spreads > VISIBLE)).tolist()
    return Candidates(
        tuple(effect for effect, is_visible in zip(effects, visible, strict=True) if is_visible),
        tuple(effect.name for effect, is_visible in zip(effects, visible, strict=True) if not is_visible),
    )


def _choices(term: Term, measurement: Measurement) -> Iterator[tuple[tuple[str, str], ...]]:
    """Yield every combination of discrete parameters; a parameter without options takes the labels of the rows."""
    values = [options or _labels(name, measurement) for name, options in term.options.items()]
    for combination in product(*values):
        yield tuple(zip(term.options, combination, strict=True))


def _labels(name: str, measurement: Measurement) -> tuple[str, ...]:
    labels = (label for trial in measurement.trials for label in trial.labels if label.name == name)
    return tuple(sorted({value for label in labels for value in label.values} - {""}))
