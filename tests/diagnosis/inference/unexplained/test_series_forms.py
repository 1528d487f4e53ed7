"""Errors of the input and numbers that drift, as rivals of the names of a time series."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY
from diagnosis.inference.unexplained.adequacy import Adequacy
from diagnosis.inference.unexplained.unlisted import BETTER, advantage, best_form, with_forms
from diagnosis.predictors.base import InputResponse

ROWS, SD_A = 120, 0.01
X = np.random.default_rng(1).uniform(-1.0, 1.0, ROWS)
NOISE_A = SD_A * np.random.default_rng(2).standard_normal(ROWS)
TIME_S = np.arange(ROWS, dtype=float)
RISES = np.where(np.diff(np.abs(X), prepend=0.0) < 0.0, -1.0, 1.0)


def series(evidence_of, readings, heldout=0):
    """Evidence of a log whose input may be wrong by a share that depends on its rise or fall."""
    (stage,) = evidence_of(X, readings + NOISE_A, heldout, session_time_s=TIME_S).stages
    error = InputResponse("x", "gain that depends on rise or fall", RISES * X)
    stage.observed = (replace(stage.observed[0], input_errors=(error,), numbers_may_drift=True),)
    return Evidence((stage,))


def fitted(evidence, hypothesis):
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    return fit


@pytest.mark.parametrize(
    ("error", "covariate", "what"),
    [
        (0.3 * TIME_S / ROWS * X, "session_time_s", "motor.torque_constant_N_m_A that drifts"),
        (0.2 * RISES * X, "x", "gain that depends on rise or fall"),
    ],
)
def test_what_is_in_no_list_takes_the_place_of_a_name(evidence_of, hypothesis, effect, error, covariate, what):
    """A gain is the best that a list offers for a constant that drifts."""
    evidence = series(evidence_of, X + error)
    nominal, named = (
        fitted(evidence, hypothesis),
        fitted(evidence, hypothesis.with_effect(effect("current_sensor_gain"))),
    )
    assert np.corrcoef(best_form(evidence, nominal).column, error)[0, 1] > 0.99
    assert advantage(evidence, nominal, named) > BETTER
    found = with_forms(evidence, nominal, named, Adequacy(()))
    assert found.has_cause
    assert (found.worst.covariate, found.worst.what) == (covariate, what)


def test_a_true_gain_is_no_drift_and_no_error_of_the_input(evidence_of, hypothesis, effect):
    evidence = series(evidence_of, 1.3 * X)
    nominal, named = (
        fitted(evidence, hypothesis),
        fitted(evidence, hypothesis.with_effect(effect("current_sensor_gain"))),
    )
    assert advantage(evidence, nominal, named) < 0.0
    assert with_forms(evidence, nominal, named, Adequacy(())).is_adequate


def test_held_out_trials_of_a_time_series_do_not_decide_between_a_form_and_a_name(evidence_of, hypothesis, effect):
    several = []
    for last in (1.3, 0.5):
        readings = np.where(TIME_S < 90, 1.3, last) * X
        evidence = series(evidence_of, readings, heldout=30)
        named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_gain")))
        several.append(advantage(evidence, fitted(evidence, hypothesis), named))
    assert several[0] == pytest.approx(several[1])


def test_a_number_that_was_chosen_for_an_error_of_the_input_has_the_penalty_of_a_parameter(evidence_of, hypothesis):
    falls = []
    for chosen in (0, 1):
        (stage,) = series(evidence_of, X + 0.2 * RISES * X).stages
        (error,) = stage.observed[0].input_errors
        stage.observed = (replace(stage.observed[0], input_errors=(replace(error, chosen=chosen),)),)
        evidence = Evidence((stage,))
        falls.append(best_form(evidence, fitted(evidence, hypothesis)).fall)
    assert falls[0] - falls[1] == pytest.approx(PARAMETER_PENALTY)
