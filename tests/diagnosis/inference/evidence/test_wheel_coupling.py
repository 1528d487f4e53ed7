"""The coupling of the wheels of a drive by the robot's body, which a case does not state."""

from pathlib import Path

import numpy as np
import pytest

from diagnosis.case_robot import base_robot_of, nominal_of
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.evidence.coupled_wheels import TOLERANCE, wheel_coupling
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.predictors import STAGES
from diagnosis.predictors.wheels import Wheels
from diagnosis.report.sentences.coupled_wheels import coupling_sentences

EXAMPLE = Path(__file__).parents[4] / "diagnosis" / "examples" / "drive_log_002"


@pytest.fixture(scope="module")
def case():
    measurement = read_measurement(EXAMPLE, IMPORTERS)
    robot = nominal_of(measurement, base_robot_of(measurement, None))
    (stage,) = (each for each in STAGES[measurement.kind](measurement, robot) if isinstance(each, Wheels))
    evidence = Evidence([stage])
    (nuisance,) = wheel_coupling(evidence, robot)
    return stage, robot, evidence, nuisance


def test_predictions_are_linear_in_the_coupling(case):
    stage, robot, evidence, nuisance = case
    both = np.nan_to_num(stage.coupling_rad_s(robot, 0.5 * TOLERANCE)).ravel()
    error = (0.5 * nuisance.change - both)[evidence.fit]
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.sqrt(np.mean(both[evidence.fit] ** 2))


@pytest.mark.parametrize(("share", "words"), [(0.08, "takes torque at the other"), (-0.08, "adds torque at the other")])
def test_a_coupling_is_found_with_its_sign(case, share, words):
    stage, robot, evidence, nuisance = case
    exact = Evidence([stage])
    (mean,) = evidence.as_measured().predicted([robot]).mean
    shifted = mean + np.nan_to_num(stage.coupling_rad_s(robot, share)).ravel()
    exact.values = exact.whitened(np.where(np.isfinite(exact.readings), shifted, np.nan))
    bare = Hypothesis(robot, (nuisance,))
    (fit,) = fits(exact, [(bare, bare.null())])
    assert fit.x[0] * TOLERANCE == pytest.approx(share, rel=0.05)
    (sentence,) = coupling_sentences(fit)
    assert words in sentence
