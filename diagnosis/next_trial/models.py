"""Predictions of all units of a library by the models that remain, relative to the noise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.evidence import EstimatedNoise, Evidence
from diagnosis.inference.evidence.sessions import session_nuisances
from diagnosis.inference.fitting.fit import at
from diagnosis.measured.measurement import CaseKind, Measurement
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
    """All samples of the measurement."""
    rows: NDArray[np.int64]
    """(N,), samples that count. Some of a drive do not, such as a range beside a corner."""
    sd: Array
    """(N,), standard deviation of the noise, as it was in the old data; larger where samples are correlated."""
    models: tuple[ModelOfUnits, ...]

    def statistics(self, library: Library) -> UnitStatistics:
        """Return what each unit of a library, whose samples these are, contributes."""
        unit = np.concatenate([library.unit_of(observed.trial) for observed in self.evidence.observed])
        return UnitStatistics(self.models, unit[self.rows], library.units, CAP)

    @property
    def as_one_unit(self) -> UnitStatistics:
        """Return the statistics with all samples as one unit."""
        return UnitStatistics(self.models, np.zeros(len(self.sd), dtype=np.int64), 1)


def predicted_units(diagnosis: Diagnosis, models: Sequence[RemainingModel], measurement: Measurement) -> PredictedUnits:
    """Return the predictions of the samples of a measurement without readings by all models.

    A drive has planned readings, and a heading, a place of the tracked body and clocks of its own: each model has the
    errors of its session as further parameters.
    """
    evidence = _evidence(diagnosis, measurement)
    is_drive = measurement.kind is CaseKind.DRIVE_LOG
    rows = np.flatnonzero(evidence.fit) if is_drive else np.arange(len(evidence.values))
    changes = _session_changes(measurement, evidence, diagnosis) if is_drive else np.empty((0, len(evidence.values)))
    levels = noise_levels(diagnosis)
    level = np.repeat([levels.get(observed.channel, 1.0) for observed in evidence.observed], evidence.counts)
    sd = evidence.sd * level / np.sqrt(evidence.weight)
    means = evidence.predicted([model.fit.robot for model in models]).mean
    predicted = []
    for model, mean in zip(models, means, strict=True):
        hypothesis = model.fit.hypothesis
        there = at(evidence, *hypothesis.of_robot(model.fit.x))
        slopes = np.zeros((hypothesis.size + len(changes), len(rows)))
        slopes[: hypothesis.size][~hypothesis.is_local] = (there.slopes * there.sd / sd)[:, rows]
        slopes[hypothesis.size :] = (changes / sd)[:, rows]
        before = np.eye(len(slopes))
        before[: hypothesis.size, : hypothesis.size] = model.fit.information
        place = np.arange(len(slopes))
        is_effect = (place >= len(hypothesis.nuisances)) & (place < hypothesis.size)
        predicted.append(ModelOfUnits((mean / sd)[rows], slopes, before, model.weight, is_effect))
    return PredictedUnits(evidence, rows, sd[rows], tuple(predicted))


def _evidence(diagnosis: Diagnosis, measurement: Measurement) -> Evidence:
    """Return the samples of a measurement with the noise that was estimated from the old data."""
    stages = STAGES[measurement.kind](measurement, diagnosis.nominal)
    # With several cases, the quantities have the names of their cases, of which the first counts.
    by_quantity: dict[str, EstimatedNoise] = {}
    for name, noise in diagnosis.evidence.noises.items():
        by_quantity.setdefault(name.partition("[")[0], noise)
    return Evidence(stages, by_quantity)


def _session_changes(measurement: Measurement, evidence: Evidence, diagnosis: Diagnosis) -> Array:
    """Return the changes of the samples (E, N) by the errors of the session of a drive, by one tolerance each.

    The session is another one than that of the old data.
    """
    trials = tuple(replace(trial, session=measurement.name) for trial in measurement.trials)
    errors = session_nuisances(replace(measurement, trials=trials), evidence, diagnosis.nominal)
    changes = [error.change for error in errors if error.change is not None]
    return np.array(changes).reshape(len(changes), len(evidence.values))


def noise_levels(diagnosis: Diagnosis) -> Mapping[str, float]:
    """Return the scatter of good readings relative to the stated noise, by channel, as a mean over the cases."""
    by_channel: dict[str, list[float]] = {}
    for observed, level in zip(diagnosis.evidence.observed, diagnosis.fit.noise.levels.tolist(), strict=True):
        by_channel.setdefault(observed.channel, []).append(level)
    return {channel: float(np.mean(levels)) for channel, levels in by_channel.items()}


def robots_of(models: Sequence[RemainingModel]) -> list[RobotConfig]:
    """Return the fitted robot of each model."""
    return [model.fit.robot for model in models]
