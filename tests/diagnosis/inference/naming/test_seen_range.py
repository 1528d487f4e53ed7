"""The range of conditions in which an effect was seen."""

import numpy as np

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.naming.seen_range import seen_ranges


def test_the_range_is_that_of_the_rows_in_which_the_effect_matters(evidence_of, hypothesis, effect):
    """A gain of 1.05 changes a reading x by 0.05 x, which is a tenth of the noise of 0.01 at x = 0.02.

    The last rows, of up to 3, are held out, and count as well.
    """
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.linspace(2.0, 3.0, 20)])
    evidence = evidence_of(x, 1.05 * x, heldout=20)
    model = hypothesis.with_effect(effect("current_sensor_gain"))
    nominal, fit = fits(evidence, [(hypothesis, hypothesis.null()), (model, model.null())])
    held = fit.hypothesis.values(model.effects[0], fit.x)["gain"]
    (seen,) = seen_ranges(evidence, nominal, fit, model.effects[0])
    assert seen.covariate == "x"
    assert seen.low == np.ceil(0.1 * 0.01 * nominal.noise.levels[0] / (held - 1.0) / 0.01) * 0.01
    assert seen.high == 3.0


def test_the_range_of_a_reading_is_what_the_model_with_the_effect_predicts(evidence_of, hypothesis, effect):
    """The nominal model predicts a current of x, and the robot with a gain of 2 reads 2 x."""
    x = np.linspace(1.0, 3.0, 121)
    evidence = evidence_of(x, 2.0 * x, heldout=20, current_A=x)
    model = hypothesis.with_effect(effect("current_sensor_gain"))
    nominal, fit = fits(evidence, [(hypothesis, hypothesis.null()), (model, model.null())])
    ranges = {seen.covariate: (seen.low, seen.high) for seen in seen_ranges(evidence, nominal, fit, model.effects[0])}
    assert ranges["x"] == (1.0, 3.0)
    np.testing.assert_allclose(ranges["current_A"], (2.0, 6.0), rtol=0.01)


def test_rows_that_are_counted_for_lack_of_times_are_no_condition(evidence_of, hypothesis, effect):
    x = np.linspace(1.0, 3.0, 121)
    evidence = evidence_of(x, 2.0 * x, heldout=20, t_s=1e6 + np.arange(121.0))
    model = hypothesis.with_effect(effect("current_sensor_gain"))
    nominal, fit = fits(evidence, [(hypothesis, hypothesis.null()), (model, model.null())])
    assert [seen.covariate for seen in seen_ranges(evidence, nominal, fit, model.effects[0])] == ["x"]
