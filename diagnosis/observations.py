"""The observations of a measurement with their noise, and the hypothesis without effects.

Its nuisances are the tolerances of the nominal parameters, the coupling of the wheels and the errors of the sessions.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from configs.effects.base import Effect
from configs.schema.robot import RobotConfig
from diagnosis.case_robot import spreads_of
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.noise_level import is_open, with_estimated_noises
from diagnosis.inference.evidence.sessions import session_nuisances, within_sessions
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Stage
from diagnosis.progress import DiagnosisProgress
from diagnosis.together import joint_nuisances, joint_stages
from symolo.core.errors import InputError

SESSION_ROUNDS = 2
"""Fits after which the errors of the sessions are where the predictions are linear in them."""
NOISE_ROUNDS = 2
"""Fits after which an unknown noise has converged; the first guess may be far off."""


def observations(
    measurement: Measurement, robot: RobotConfig, progress: DiagnosisProgress
) -> tuple[Evidence, Hypothesis]:
    """Return the observations of all stages, and the hypothesis without effects.

    Raises:
        InputError: No stage of the simulator predicts such data, or none of the data can be used.
    """
    if measurement.cases:
        stages = joint_stages(measurement, robot)
        bare = Hypothesis(robot, joint_nuisances(measurement, robot, Evidence(stages)) if stages else ())
    else:
        stages = STAGES[measurement.kind](measurement, robot)
        bare = Hypothesis(robot, spreads_of(measurement, robot))
    where = measurement.where
    if not stages:
        cure = "log voltages and counts, counts and poses, or poses and ranges"
        raise InputError("no reading that a stage could predict from the logged inputs", where=where, cure=cure)
    evidence = observed_by(stages, bare, progress)
    if not evidence.fit.any():
        raise InputError("no usable sample to fit", where=where, cure="log inputs and readings in the same rows")
    return evidence, bare


def observed_by(stages: Sequence[Stage], bare: Hypothesis, progress: DiagnosisProgress | None = None) -> Evidence:
    """Return the observations with their noise, which is estimated from the nominal model if it is not stated."""
    evidence = Evidence(stages)
    if progress is not None:
        evidence.on_predicted, evidence.on_fits = progress.predicted, progress.fits
    rounds = NOISE_ROUNDS if evidence.fit.any() else 0
    for _ in range(rounds if any(is_open(observed) for observed in evidence.observed) else 0):
        (fit,) = fits(evidence, [(bare, bare.null())])
        evidence = with_estimated_noises(evidence, fit)
    return evidence


def with_sessions(
    measurement: Measurement, evidence: Evidence, bare: Hypothesis
) -> tuple[Hypothesis, Collection[type[Effect]]]:
    """Return a hypothesis with the nuisances of the sessions, linearised where the data have them, and their effects.

    The effects are those that the sessions explain, so that they are none of the robot.
    """
    errors, session_effects = session_nuisances(measurement, evidence, bare.nominal), ()
    for _ in range(SESSION_ROUNDS if errors else 0):
        hypothesis = replace(bare, nuisances=(*bare.nuisances, *errors))
        (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
        errors, session_effects = session_nuisances(measurement, evidence, bare.nominal, fit), within_sessions(fit)
    return replace(bare, nuisances=(*bare.nuisances, *errors)), session_effects
