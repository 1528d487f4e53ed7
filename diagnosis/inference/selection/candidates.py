"""Candidate effects: every registered effect that changes the predictions of a measurement, with each of its choices.

The registries are the only list of effects. Whether an effect matters is found by trying it: if its start values change
no prediction of the data, the data can neither show nor exclude it, and it is reported as untestable.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from configs.effects.base import RANDOM_SLOTS, Effect, Setup
from configs.effects.registry import EFFECTS
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.selection.scan import starts
from diagnosis.measured.measurement import CaseKind, Measurement

SETUPS = {
    CaseKind.MOTOR_STEADY: {Setup.MOTOR_BENCH},
    CaseKind.MOTOR_STEP: {Setup.MOTOR_BENCH},
    CaseKind.TOF_BENCH: {Setup.RANGE_BENCH},
    CaseKind.RANGE_SCAN: {Setup.RANGE_SCAN},
    CaseKind.DRIVE_LOG: {Setup.DRIVE},
    CaseKind.SYMOLO_CSV: {Setup.DRIVE, Setup.LINE_LOG},
}
"""Setups of each kind of measurement. An effect names the setups to which it applies: a drive has range effects of its
own, by sensor, since those of the bench would be the same under another name."""
VISIBLE = 1e-3
"""Change of a prediction in sigmas, at the start values, from which an effect is testable."""


@dataclass(frozen=True)
class Candidates:
    """The effects that may explain a measurement."""

    testable: tuple[CandidateEffect, ...]
    untestable: tuple[str, ...]
    """Names of effects that the data cannot show, and of single choices where the data show others or the nominal robot
    has another one.
    """


def candidates(measurement: Measurement, evidence: Evidence, hypothesis: Hypothesis) -> Candidates:
    """Return the candidate effects of a measurement; `hypothesis` has the nuisances and no effects."""
    setups = setups_of(measurement)
    several = {
        (effect, choices): CandidateEffect.on_top_of(hypothesis.nominal, effect, choices)
        for effect in EFFECTS.classes()
        # What is random moves no prediction; see `inference.unexplained.drift.random_drift` and `posterior.slip`.
        if not setups.isdisjoint(effect.setups) and effect.slot not in RANDOM_SLOTS
        for choices in _choices(effect, measurement)
    }
    effects = [effect for effect in several.values() if effect is not None]
    refused = [CandidateEffect(*key).name for key, effect in several.items() if effect is None]
    robots = [hypothesis.robot(hypothesis.null())]
    for effect in effects:
        extended = hypothesis.with_effect(effect)
        x = np.array([c.start for c in extended.coordinates])
        x[extended.parameters(effect)] = starts(evidence, effect)
        robots.append(extended.robot(x))
    prediction = evidence.predicted(robots)
    # Effects are visible if the mean or the noise of any sample changes.
    moves = np.abs((prediction.mean[1:] - prediction.mean[:1]) / evidence.sd)[:, evidence.fit].max(axis=1, initial=0.0)
    spreads = np.abs(np.log(prediction.sd[1:] / prediction.sd[:1]))[:, evidence.fit].max(axis=1, initial=0.0)
    visible = ((moves > VISIBLE) | (spreads > VISIBLE)).tolist()
    testable = tuple(effect for effect, is_visible in zip(effects, visible, strict=True) if is_visible)
    kinds = {effect.kind for effect in testable}
    hidden = [effect.name if effect.kind in kinds else effect.kind.name for effect in effects if effect not in testable]
    return Candidates(testable, tuple(dict.fromkeys([*hidden, *refused])))


def setups_of(measurement: Measurement) -> set[Setup]:
    """Return the setups of a measurement; an effect with none of them is not looked for."""
    return {setup for case in measurement.cases or (measurement,) for setup in SETUPS[case.kind]}


def _choices(effect: type[Effect], measurement: Measurement) -> Iterator[tuple[tuple[str, str], ...]]:
    """Yield every combination of discrete parameters; a parameter without options takes the labels of the rows."""
    options = effect.options()
    values = [fixed or _labels(name, measurement) for name, fixed in options.items()]
    for combination in product(*values):
        yield tuple(zip(options, combination, strict=True))


def _labels(name: str, measurement: Measurement) -> tuple[str, ...]:
    labels = (label for trial in measurement.trials for label in trial.labels if label.name == name)
    return tuple(sorted({value for label in labels for value in label.values} - {""}))
