"""Data of the report beyond the diagnosis itself: the model without each effect, gains by quantity, signatures."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from diagnosis.dataset_comparison import DatasetComparison, compare_with_dataset
from diagnosis.diagnose import Diagnosis
from diagnosis.engine.gain import EngineComparison, compare_engines
from diagnosis.extended_robot import ExtendedRobot, extended_robot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import moved
from diagnosis.inference.fitting.profile import Interval, profiles
from diagnosis.inference.gain import Gain, evidence_of_quantity, gain
from diagnosis.inference.log_score import LogScoreChange, log_score_change
from diagnosis.inference.naming.file_numbers import cost_with_file_numbers
from diagnosis.inference.naming.transfer import trial_groups
from diagnosis.inference.selection.refusal import is_of_noise
from diagnosis.inference.unexplained.adequacy import Adequacy, Structure, adequacy
from diagnosis.inference.unexplained.scatter import SCATTER
from diagnosis.inference.unexplained.uneven_noise import UNEVEN
from diagnosis.measured.measurement import Measurement
from diagnosis.posterior.predictive_check import CheckedStatistic, predictive_check
from diagnosis.posterior.random_slip import RandomSlipEstimate, random_slip
from diagnosis.prediction_error import UnseenPrediction, predictions
from diagnosis.report.sentences.data.coupled_wheels import coupling_sentences
from diagnosis.report.sentences.data.random_slip import random_slip_sentences
from diagnosis.report.sentences.data.rows import row_sentences
from diagnosis.report.sentences.data.run_ends import run_ends
from diagnosis.report.sentences.data.sessions import session_sentences
from diagnosis.report.sentences.effects.unnamed_own_effects import TriedEffect, tried_effects
from diagnosis.report.signatures import Signatures, signatures
from symolo.core.arrays import Array


@dataclass(frozen=True)
class Ablation:
    """The extended model without one of its effects; all other parameters are fitted again."""

    name: str
    fit: HypothesisFit
    cost_rise: float
    gain: Gain | None
    """Gain over the nominal robot without the effect."""
    effect_gain: Gain | None
    """Gain of the extended model over the model without the effect."""
    log_score: LogScoreChange | None
    """Change of the log-likelihood of a held-out reading by the effect."""
    is_of_noise: bool
    """Whether the effect changes only the noise, which shows in the log score and not in the gain."""


@dataclass(frozen=True)
class PartGain:
    """Gains on a part of the held-out samples."""

    name: str
    calibrated: Gain
    extended: Gain


@dataclass(frozen=True)
class ReportData:
    """Everything that the files of a diagnosis show."""

    diagnosis: Diagnosis
    robot: ExtendedRobot
    structures: tuple[Structure, ...]
    """Structure along whose covariate the misfit of each observed quantity is shown: that which the verdict reports, or
    else that of the nominal robot with fitted nuisances."""
    ablations: tuple[Ablation, ...]
    """Model without each named effect, in the order of the effects."""
    intervals: Mapping[str, Mapping[str, tuple[Interval, ...]]]
    """Profile intervals by effect and parameter, for the parameters that the data determine."""
    rise_with_file: Mapping[str, float]
    """Rise of the cost by named effect, with its numbers held at those that its file states; only where it states
    them."""
    by_quantity: tuple[PartGain, ...]
    by_group: tuple[PartGain, ...]
    """Gains in each manoeuvre or group of trials; empty if there is one only."""
    by_case: tuple[PartGain, ...]
    """Gains in each of several cases that were fitted together; empty for a single case."""
    signatures: Signatures
    means: tuple[Array, Array, Array]
    """Predictions (N,) of the nominal robot, of the same with its nuisances fitted, and of the extended robot."""
    z: tuple[Array, Array, Array]
    """Residuals (N,) of the three robots in standard deviations of the nominal noise; NaN if not usable. The random
    drift of a range sensor is in them, as in the gains."""
    row_sentences: tuple[str, ...] = ()
    """Sentences about single rows of a bench, or sessions, slip and whole runs of a drive."""
    engines: EngineComparison | None = None
    """Errors with PyBullet; None if not requested."""
    dataset: DatasetComparison | None = None
    """Comparison with a dataset; None if none was named."""
    own_effects: tuple[TriedEffect, ...] = ()
    """Effects of the user's own that are not named."""
    unseen: tuple[UnseenPrediction, ...] = ()
    """Predictions of the extended robot for unseen runs of the case."""
    predictive: tuple[CheckedStatistic, ...] = ()
    """Statistics of the measured readings among those of robots from the posterior."""


def report_data(
    diagnosis: Diagnosis,
    *,
    pybullet: bool = False,
    release: Measurement | None = None,
    unseen: Mapping[str, Measurement] = MappingProxyType({}),
) -> ReportData:
    """Return everything that is shown of a diagnosis.

    Args:
        diagnosis: The diagnosis of a measurement.
        pybullet: Whether to simulate the robots with PyBullet too, which may take minutes.
        release: A dataset to compare with the measurement.
        unseen: Inputs of runs without readings, by file name.

    Raises:
        InputError: The dataset or the measurement is no drive.
    """
    evidence, measured, nominal = diagnosis.evidence, diagnosis.measured, diagnosis.selection.nominal
    measured = measured.as_measured()
    prediction = measured.predicted((diagnosis.nominal, nominal.robot, diagnosis.extended))
    changes = (0.0, nominal.local_change, diagnosis.fit.local_change)
    means = [mean + change for mean, change in zip(prediction.mean, changes, strict=True)]
    usable = measured.fit | measured.heldout
    slip, names = random_slip(diagnosis), [observed.name for observed in evidence.observed]
    z = np.where(usable, (measured.values - np.stack(means)) / measured.sd, np.nan)
    return ReportData(
        diagnosis=diagnosis,
        robot=extended_robot(diagnosis, () if slip is None else (slip.effect,)),
        structures=tuple(shown_structures(diagnosis.unexplained, adequacy(evidence, nominal), names)),
        ablations=tuple(_ablations(diagnosis)),
        intervals=profiles(evidence, diagnosis.fit),
        by_quantity=tuple(_by_quantity(diagnosis)),
        by_group=tuple(_by_group(diagnosis)),
        by_case=tuple(_by_case(diagnosis)),
        signatures=signatures(evidence, nominal, diagnosis.candidates.testable),
        row_sentences=_row_sentences(diagnosis, slip),
        means=(means[0], means[1], means[2]),
        z=(z[0], z[1], z[2]),
        engines=compare_engines(diagnosis.measurement, diagnosis.nominal, diagnosis.extended) if pybullet else None,
        dataset=None if release is None else compare_with_dataset(diagnosis.measurement, release, diagnosis.nominal),
        rise_with_file=_rise_with_file(diagnosis),
        own_effects=tuple(tried_effects(diagnosis)),
        unseen=predictions(diagnosis, unseen),
        predictive=predictive_check(diagnosis),
    )


def _row_sentences(diagnosis: Diagnosis, slip: RandomSlipEstimate | None) -> tuple[str, ...]:
    return (
        *row_sentences(diagnosis),
        *session_sentences(diagnosis.fit),
        *coupling_sentences(diagnosis.fit),
        *random_slip_sentences(slip),
        *run_ends(diagnosis),
    )


def _rise_with_file(diagnosis: Diagnosis) -> Mapping[str, float]:
    """Return the rise of the cost with the numbers of an effect's file, by the names of the effects that have one."""
    fit = diagnosis.fit
    return {
        named.effect.name: cost_with_file_numbers(diagnosis.evidence, fit, named.effect) - fit.cost
        for named in diagnosis.named
        if named.file_numbers
    }


def shown_structures(unexplained: Structure | None, nominal: Adequacy, observed: Iterable[str]) -> Iterator[Structure]:
    """Yield the structure along which the misfit of each observed quantity is shown, if there is any.

    Args:
        unexplained: The structure that the verdict reports; None if there is none.
        nominal: Structures in the residuals of the nominal robot with fitted nuisances.
        observed: Names of the observed quantities.
    """
    for name in observed:
        adequacy = nominal.restricted_to(name)
        if (
            unexplained is not None
            and unexplained.observed == name
            and not unexplained.what.startswith((SCATTER, UNEVEN))
        ):
            yield unexplained
        elif adequacy.structures:
            yield adequacy.worst


def _ablations(diagnosis: Diagnosis) -> Iterator[Ablation]:
    fit, evidence, measured = diagnosis.fit, diagnosis.evidence, diagnosis.measured
    fewer = [fit.hypothesis.without(named.effect) for named in diagnosis.named]
    refits = fits(evidence, [(hypothesis, moved(fit.x, fit.hypothesis, hypothesis)) for hypothesis in fewer])
    for named, refit in zip(diagnosis.named, refits, strict=True):
        yield Ablation(
            name=named.effect.name,
            fit=refit,
            cost_rise=refit.cost - fit.cost,
            gain=gain(measured, diagnosis.nominal, refit.robot, (0.0, refit.local_change)),
            effect_gain=gain(measured, refit.robot, diagnosis.extended, (refit.local_change, fit.local_change)),
            log_score=log_score_change(evidence, refit, fit),
            is_of_noise=is_of_noise(fit, named.effect),
        )


def _by_quantity(diagnosis: Diagnosis) -> Iterator[PartGain]:
    evidence = diagnosis.measured
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        yield from _gain_clause(observed.name, evidence_of_quantity(evidence, place), diagnosis)


def _by_group(diagnosis: Diagnosis) -> Iterator[PartGain]:
    evidence = diagnosis.measured
    names = [trial.name for trial in diagnosis.measurement.trials]
    for group in trial_groups(evidence, names, evidence.heldout):
        yield from _gain_clause(group.name, evidence.with_rows(heldout=group.rows), diagnosis)


def _by_case(diagnosis: Diagnosis) -> Iterator[PartGain]:
    evidence, first = diagnosis.measured, 0
    for case in diagnosis.measurement.cases:
        rows = (evidence.trial >= first) & (evidence.trial < first + len(case.trials))
        first += len(case.trials)
        yield from _gain_clause(case.name, evidence.with_rows(heldout=evidence.heldout & rows), diagnosis)


def _gain_clause(name: str, evidence: Evidence, diagnosis: Diagnosis) -> Iterator[PartGain]:
    nominal, adjusted = diagnosis.nominal, diagnosis.selection.nominal
    calibration = gain(evidence, nominal, adjusted.robot, (0.0, adjusted.local_change))
    extension = gain(evidence, nominal, diagnosis.extended, (0.0, diagnosis.fit.local_change))
    if calibration is not None and extension is not None:
        yield PartGain(name, calibration, extension)
