"""Standard errors where the readings depend on a parameter by a bent line, with all numbers in closed form."""

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.fitting.standard_errors import standard_errors
from diagnosis.predictors.base import Predicted
from sensors.effects.motor_bench.current_sensor_offset import CurrentSensorOffset

SD_A = 0.01
ROWS = 100
X = np.linspace(0.5, 1.0, ROWS)
STD_A = SD_A / np.sqrt(ROWS)
OFFSET_A = 0.02


@dataclass
class BentBench:
    """I = x + offset up to the bend, and x + bend + slope * (offset - bend) beyond it."""

    observed: tuple
    bend_A: float
    slope: float
    name: str = "motor"
    at_once: int = 48

    def predict(self, robots):
        offsets = np.array([robot.effects.get(CurrentSensorOffset).offset_A for robot in robots])
        beyond = np.maximum(offsets - self.bend_A, 0.0)
        return (Predicted(X + (offsets - (1.0 - self.slope) * beyond)[:, None], self.observed[0].sd),)


@pytest.fixture
def error_of(evidence_of, robot, effect):
    """Standard errors of an offset OFFSET_A by curvature, and by the cost."""
    model = Hypothesis(robot, ()).with_effect(effect("current_sensor_offset"))
    (offset,) = model.effects
    readings = X + OFFSET_A + SD_A * (-1.0) ** np.arange(ROWS)

    def found(bend_A, slope):
        evidence = Evidence((BentBench(evidence_of(X, readings).observed, bend_A, slope),))
        (fit,) = fits(evidence, [(model, model.null())])
        return fit.std(offset)["offset_A"], standard_errors(evidence, fit, offset)["offset_A"]

    return found


def test_of_a_straight_model_the_standard_error_is_that_of_the_curvature(error_of):
    by_curvature, error = error_of(1.0, 1.0)
    assert error == by_curvature == pytest.approx(STD_A, rel=0.05)


def test_beyond_a_bend_the_standard_error_is_a_third_of_the_distance_that_three_of_the_readings_allow(error_of):
    """The bend is one standard error above the fit, so that the other two are ten times as far: (1 + 2 * 10) / 3."""
    by_curvature, error = error_of(OFFSET_A + STD_A, 0.1)
    assert by_curvature == pytest.approx(STD_A, rel=0.05)
    assert error == pytest.approx(7.0 * STD_A, rel=0.1)


def test_a_cost_that_is_steeper_on_one_side_leaves_the_standard_error_as_it_is(error_of):
    by_curvature, error = error_of(OFFSET_A + STD_A, 10.0)
    assert error == by_curvature
