"""The coupling of the wheels of a drive by the robot's body, which a case does not state."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.case_robot import base_robot_of, nominal_of
from diagnosis.importers import IMPORTERS
from diagnosis.importers.cases.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.evidence.coupled_wheels import TOLERANCE, fitted_coupling, wheel_coupling
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.prediction_error import predictions
from diagnosis.predictors import STAGES
from diagnosis.predictors.wheels.speeds import Wheels
from diagnosis.report.answer import answer
from diagnosis.report.report_data import report_data
from diagnosis.report.sentences.data.coupled_wheels import coupling_sentences
from diagnosis.together import joint_robot, joint_stages, together

EXAMPLE = Path(__file__).parents[4] / "diagnosis" / "examples" / "drive_log_002"
FILE = f"{EXAMPLE.name}_wheels.csv"


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


def test_cases_of_one_robot_have_one_coupling(case):
    _, _, _, alone = case
    measurement = read_measurement(EXAMPLE, IMPORTERS)
    both = together([measurement, replace(measurement, name="another drive")])
    robot = joint_robot(both, base_robot_of(measurement, None))
    evidence = Evidence(joint_stages(both, robot))
    (nuisance,) = wheel_coupling(evidence, robot)
    wheels = [place for o, place in zip(evidence.observed, evidence.places, strict=True) if o.name.startswith("wheel_")]
    change = np.concatenate([nuisance.change[place] for place in wheels])
    np.testing.assert_allclose(change, np.tile(alone.change, 2), atol=1e-9)
    assert np.count_nonzero(nuisance.change) == np.count_nonzero(change)


@pytest.fixture(scope="module")
def diagnosis(diagnosed_among):
    """The diagnosis of voltages and counts alone, without any effect."""
    measurement = read_measurement(EXAMPLE, IMPORTERS)
    trials = []
    for trial in measurement.trials:
        channels = tuple(channel for channel in trial.channels if channel.name.startswith(("u_", "enc_")))
        trials.append(replace(trial, channels=channels))
    return diagnosed_among(replace(measurement, trials=tuple(trials)))


def coupled(diagnosis, share, std=0.0):
    """Return the diagnosis as if the fit had this coupling, with so much more uncertainty."""
    fit, place = diagnosis.fit, fitted_coupling(diagnosis.fit).place
    x, more = fit.x.copy(), np.zeros_like(fit.covariance)
    x[place], more[place, place] = share / TOLERANCE, (std / TOLERANCE) ** 2
    shared = more if fit.shared is None else fit.shared + more
    return replace(diagnosis, fit=replace(fit, x=x, shared=shared))


def test_an_unseen_run_is_predicted_with_the_coupling_and_its_error(diagnosis):
    unseen = read_blind(EXAMPLE, diagnosis.measurement.kind)
    bare, fitted, wide = (
        {each.file: each.columns for each in predictions(coupled(diagnosis, share, std), unseen)}[FILE]
        for share, std in ((0.0, 0.0), (0.06, 0.0), (0.0, 0.06))
    )
    runs = replace(unseen["blind_wheels_inputs.csv"], nominal=diagnosis.measurement.nominal)
    by_share = Wheels(runs, diagnosis.nominal).coupling_rad_s(diagnosis.nominal, 0.06)
    for column, change in zip(("wheel_left_rad_s", "wheel_right_rad_s"), by_share, strict=True):
        largest = np.nanmax(np.abs(change))
        assert largest > 0.01
        np.testing.assert_allclose(fitted[column] - bare[column], change, atol=0.1 * largest)
        more = np.sqrt(wide[f"sd_{column}"] ** 2 - bare[f"sd_{column}"] ** 2)
        np.testing.assert_allclose(more, np.abs(change), atol=0.1 * largest)


def test_the_answer_states_the_coupling(diagnosis):
    stated = answer(report_data(coupled(diagnosis, 0.04)))["wheel_coupling"]
    assert stated == {"share": pytest.approx(0.04), "std": pytest.approx(fitted_coupling(diagnosis.fit).std)}
