"""A fit to speeds from counts is that of generalised least squares, by a covariance that is written down here."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import EstimatedNoise, Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.gain import gain
from diagnosis.inference.unexplained.adequacy import CLUSTER, adequacy
from diagnosis.nuisances import Nuisance
from diagnosis.predictors.base import Covariate, Observed, Predicted
from diagnosis.predictors.wheels.count_noise import CountNoise

ROWS, ROUNDING, TORQUE = 400, 0.04, 0.01


@dataclass
class Standing:
    """A stage that predicts no speed at all."""

    observed: tuple
    name: str = "wheels"
    at_once: int = 48

    def predict(self, robots):
        return (Predicted(np.zeros((len(robots), ROWS)), self.observed[0].sd),)


@pytest.fixture
def evidence():
    """Speeds with a step of 0.004 rad/s in the middle, whose noise is nearly that of rounded counts alone."""
    rng = np.random.default_rng(3)
    rounded = ROUNDING / np.sqrt(2.0) * rng.standard_normal(ROWS + 1)
    values = 0.004 * step() + np.diff(rounded) + TORQUE * rng.standard_normal(ROWS)
    goes_on = np.arange(ROWS) > 0
    everywhere, sd = np.ones(ROWS, dtype=bool), float(np.hypot(ROUNDING, TORQUE))
    observed = Observed(
        name="wheel_left_rad_s",
        channel="wheel_speed_rad_s",
        unit="rad/s",
        values=values,
        sd=np.full(ROWS, sd),
        correlation=None,
        count_noise=CountNoise(np.full(ROWS, ROUNDING), goes_on, everywhere, 1e-6, sd),
        trial=np.zeros(ROWS, dtype=int),
        t_s=0.05 * np.arange(ROWS),
        holdout=~everywhere,
        usable=everywhere,
    )
    return Evidence([Standing((observed,))])


def test_a_gain_is_that_of_the_readings(evidence, robot):
    (observed,) = evidence.observed
    heldout = Evidence([Standing((replace(observed, holdout=np.arange(ROWS) >= ROWS // 2),))])
    gained = gain(heldout, robot, robot, (0.0, 0.004 * step()))
    lacks = np.sort(np.abs(observed.values[ROWS // 2 :] - np.array([[0.0], [0.004]]))) / observed.sd[0]
    # Without the largest 3 %, rounded up.
    before, after = np.sqrt(np.mean(lacks[:, : ROWS // 2 - 6] ** 2, axis=1))
    assert gained.by_quantity == ((observed.name, pytest.approx(before), pytest.approx(after)),)


def step():
    return np.where(np.arange(ROWS) < ROWS // 2, 0.0, 1.0)


def same(robot, _value):
    return robot


def test_a_step_and_its_error_are_those_of_generalised_least_squares(evidence, robot):
    hypothesis = Hypothesis(robot, (Nuisance("step", 0.0, 1.0, "1", same, step()),))
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    apart = np.abs(np.subtract.outer(np.arange(ROWS), np.arange(ROWS)))
    # A motor without inertia keeps no speed, so that the torques of two rows have nothing in common.
    covariance = ROUNDING**2 * np.where(apart == 0, 1.0, np.where(apart == 1, -0.5, 0.0)) + TORQUE**2 * (apart == 0)
    by_covariance = np.linalg.solve(covariance, step())
    variance = 1.0 / (by_covariance @ step())
    expected = variance * (by_covariance @ evidence.readings)
    assert np.sqrt(np.diag(fit.covariance)) == pytest.approx(np.sqrt(variance), rel=0.1)
    assert fit.x == pytest.approx(expected, abs=0.1 * np.sqrt(variance))
    # As if the speeds were independent, the error would be several times as large.
    assert np.sqrt(variance) < 0.4 * np.hypot(ROUNDING, TORQUE) / np.sqrt(ROWS // 4)


def test_readings_and_their_errors_are_as_measured_again(evidence):
    assert evidence.as_measured().values is evidence.readings
    assert evidence.unwhitened(0, evidence.values) == pytest.approx(evidence.readings, abs=1e-12)


def test_a_torque_that_scatters_twice_as_much_as_stated_makes_no_outliers_of_neighbours(evidence, robot):
    """Neighbours have its error in common, so that speeds far off by the statement come in groups."""
    (observed,) = evidence.observed
    noise = replace(observed.count_noise, rounding=np.full(ROWS, 0.2 * observed.sd[0]), keep=0.9)
    torque = 2.0 * observed.sd[0]
    clusters = 0
    for seed in range(10):
        innovations = observed.sd[0] * np.random.default_rng(seed).standard_normal(ROWS)
        speeds = replace(
            observed,
            values=noise.whitening(torque).undone(innovations),
            count_noise=noise,
            covariates=(Covariate("t_s", observed.t_s),),
        )
        noisier = Evidence([Standing((speeds,))], {speeds.name: EstimatedNoise(1.0, 0.0, torque=torque)})
        bare = Hypothesis(robot, ())
        (fit,) = fits(noisier, [(bare, bare.null())])
        clusters += any(found.what == CLUSTER for found in adequacy(noisier, fit).structures)
    assert clusters == 0
