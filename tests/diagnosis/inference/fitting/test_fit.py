"""Fits of a linear bench against the closed form of a least-squares fit with a prior."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import Contest, fits, fits_of_contests
from diagnosis.inference.fitting.hypothesis import moved
from diagnosis.predictors.base import Predicted

SD_A, TOLERANCE = 0.01, 0.02
X = np.linspace(0.2, 1.0, 40)


def ridge(readings):
    """Mean and covariance of (deviation of K in tolerances, offset [A]) by the normal equations."""
    design = np.stack([X * TOLERANCE, np.ones_like(X)], axis=1) / SD_A
    information = design.T @ design + np.diag([1.0, 0.0])
    return np.linalg.solve(information, design.T @ ((readings - X) / SD_A)), np.linalg.inv(information)


def test_a_fit_is_the_closed_form_of_min_squares_with_a_prior(evidence_of, hypothesis, effect):
    # Residuals of one sigma, so that the fitted noise is the stated one.
    readings = X * 1.01 + 0.003 + SD_A * (-1.0) ** np.arange(40)
    offset = effect("current_sensor_offset")
    model = hypothesis.with_effect(offset)
    (fit,) = fits(evidence_of(X, readings), [(model, model.null())])
    (deviation, shift), covariance = ridge(readings)
    assert fit.x[0] == pytest.approx(deviation, rel=0.02)
    assert model.values(offset, fit.x)["offset_A"] == pytest.approx(shift, rel=0.02)
    assert fit.std(offset)["offset_A"] == pytest.approx(np.sqrt(covariance[1, 1]), rel=0.02)


def test_rows_held_out_do_not_matter(evidence_of, hypothesis):
    spoilt = np.append(X[:30], X[30:] + 5.0)
    (whole,) = fits(evidence_of(X[:30], X[:30] * 1.02), [(hypothesis, hypothesis.null())])
    (held,) = fits(evidence_of(X, np.append(X[:30] * 1.02, spoilt[30:]), heldout=10), [(hypothesis, hypothesis.null())])
    assert held.x == pytest.approx(whole.x)


def test_a_wild_reading_moves_the_fit_by_no_more_than_its_corner_allows(evidence_of, hypothesis, effect):
    """The pull of a sample is at most 3 sigmas, so that one in 40 moves their mean by 3/40 sigma and a little."""
    readings = X.copy()
    readings[7] += 100.0
    offset = effect("current_sensor_offset")
    model = hypothesis.with_effect(offset)
    (fit,) = fits(evidence_of(X, readings), [(model, model.null())])
    assert abs(model.values(offset, fit.x)["offset_A"]) < 4.0 * 3.0 / 40.0 * SD_A


def test_many_fits_side_by_side_are_each_alone(evidence_of, hypothesis, effect):
    evidence = evidence_of(X, X * 0.98 + 0.015 + SD_A * (-1.0) ** np.arange(40))
    models = [
        hypothesis,
        *(hypothesis.with_effect(effect(n)) for n in ("current_sensor_offset", "current_sensor_gain")),
    ]
    together = fits(evidence, [(model, model.null()) for model in models])
    for model, fit in zip(models, together, strict=True):
        (alone,) = fits(evidence, [(model, model.null())])
        np.testing.assert_allclose(fit.x, alone.x, rtol=1e-9)


def test_contests_side_by_side_are_each_alone_and_share_their_predictions(evidence_of, hypothesis, effect):
    """Each has rows, a goal and a noise of its own; a fit far behind its goal must not stop those of other contests."""
    batches, whole = [], evidence_of(X, X * 0.98 + 0.015 + SD_A * (-1.0) ** np.arange(40))
    whole.on_predicted = batches.append
    model = hypothesis.with_effect(effect("current_sensor_offset"))
    (known,) = fits(whole, [(model, model.null())])
    starts = [(each, each.null()) for each in (hypothesis, model)]
    contests = [
        Contest(whole, starts, goal=-1e6),
        Contest(whole.with_rows(fit=whole.fit & (X > 0.5)), starts, noises=[known.noise, known.noise]),
        Contest(whole, []),
    ]
    batches.clear()
    alone = [fits(each.evidence, each.starts, each.goal, each.noises) for each in contests[:2]]
    one_after_the_other = len(batches)
    *together, nothing = fits_of_contests(contests)
    assert len(batches) - one_after_the_other < one_after_the_other
    assert nothing == []
    for apart, beside in zip(alone, together, strict=True):
        for one, other in zip(apart, beside, strict=True):
            np.testing.assert_array_equal(one.x, other.x)
            assert one.cost == other.cost


def test_coordinates_of_one_hypothesis_are_found_again_in_another(hypothesis, effect):
    gain, offset = effect("current_sensor_gain"), effect("current_sensor_offset")
    of, to = hypothesis.with_effect(gain), hypothesis.with_effect(offset).with_effect(gain)
    x = np.array([0.7, 0.1])
    assert moved(x, of, to) == pytest.approx([0.7, 0.0, 0.1])


def test_what_the_data_do_not_hold_has_no_error_that_could_be_believed(evidence_of, hypothesis, effect):
    """Without any offset to speak of, the current's limit may be anywhere above the largest."""
    limit = effect("current_limit")
    model = hypothesis.with_effect(limit)
    (fit,) = fits(evidence_of(X, X), [(model, model.null())])
    assert fit.std(limit)["limit_A"] == np.inf


class FailsBeyond:
    """A stage without a prediction of its last row for robots whose current sensor reads more than a limit too much."""

    def __init__(self, stage, limit_A):
        self._stage, self._limit_A = stage, limit_A

    def __getattr__(self, name):
        return getattr(self._stage, name)

    def predict(self, robots):
        (predicted,) = self._stage.predict(robots)
        mean = predicted.mean.copy()
        for k, robot in enumerate(robots):
            if any(sensor.offset_A > self._limit_A for sensor in robot.effects):
                mean[k, -1] = np.nan
        return (Predicted(mean, predicted.sd),)


@pytest.mark.parametrize(("start", "offset_A"), [(0.0, 0.02), (3.0, 0.005)], ids=["towards a gap", "from a gap"])
def test_a_fit_ends_where_every_row_has_a_prediction(evidence_of, hypothesis, effect, start, offset_A):
    evidence = evidence_of(X, X + offset_A + SD_A * (-1.0) ** np.arange(40))
    evidence.stages = (FailsBeyond(evidence.stages[0], 0.01),)
    offset = effect("current_sensor_offset")
    model = hypothesis.with_effect(offset)
    x = model.null()
    x[-1] = start
    (fit,) = fits(evidence, [(model, x)])
    assert np.isfinite(fit.cost)
    assert 0.0 < model.values(offset, fit.x)["offset_A"] <= 0.01
