"""Predictions of all units of a library by the models that remain, relative to the noise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import at
from diagnosis.measured.measurement import Measurement
from diagnosis.next_trial.library.base import Library
from diagnosis.next_trial.remaining import RemainingModel
from diagnosis.next_trial.separation import ModelOfUnits, UnitStatistics
from diagnosis.predictors import STAGES
from symolo.core.arrays import Array

CAP = 3.0
"""Difference in standard deviations that a reading is worth at most; a fit takes single larger ones for outliers."""


@dataclass(frozen=True, eq=False)
class PredictedUnits:
    """Samples of a measurement as each model predicts them."""

    evidence: Evidence
    """The samples, without values."""
    sd: Array
    """(N,), standard deviation of the noise, as it was in the old data; larger where samples are correlated."""
    models: tuple[ModelOfUnits, ...]

    def statistics(self, library: Library) -> UnitStatistics:
        """Return what each unit of a library, whose samples these are, contributes."""
        unit = np.concatenate([library.unit_of(observed.trial) for observed in self.evidence.observed])
        return UnitStatistics(self.models, unit, library.units, CAP)

    @property
    def as_one_unit(self) -> UnitStatistics:
        """Return the statistics with all samples as one unit."""
        return UnitStatistics(self.models, np.zeros(len(self.sd), dtype=np.int64), 1)


def predicted_units(diagnosis: Diagnosis, models: Sequence[RemainingModel], measurement: Measurement) -> PredictedUnits:
    """Return the predictions of the samples of a measurement without readings by all models."""
    evidence = Evidence(STAGES[measurement.kind](measurement, diagnosis.nominal))
    levels = noise_levels(diagnosis)
    level = np.repeat([levels.get(observed.channel, 1.0) for observed in evidence.observed], evidence.counts)
    sd = evidence.sd * level / np.sqrt(evidence.weight)
    means = evidence.predicted([model.fit.robot for model in models]).mean
    predicted = []
    for model, mean in zip(models, means, strict=True):
        hypothesis = model.fit.hypothesis
        there = at(evidence, hypothesis, model.fit.x)
        of_effects = np.arange(hypothesis.size) >= len(hypothesis.nuisances)
        predicted.append(
            ModelOfUnits(mean / sd, there.slopes * there.sd / sd, model.fit.information, model.weight, of_effects)
        )
    return PredictedUnits(evidence, sd, tuple(predicted))


def noise_levels(diagnosis: Diagnosis) -> Mapping[str, float]:
    """Return the scatter of good readings relative to the stated noise, by channel, as a mean over the cases."""
    by_channel: dict[str, list[float]] = {}
    for observed, level in zip(diagnosis.evidence.observed, diagnosis.fit.noise.levels.tolist(), strict=True):
        by_channel.setdefault(observed.channel, []).append(level)
    return {channel: float(np.mean(levels)) for channel, levels in by_channel.items()}


def robots_of(models: Sequence[RemainingModel]) -> list[RobotConfig]:
    """Return the fitted robot of each model."""
    return [model.fit.robot for model in models]
