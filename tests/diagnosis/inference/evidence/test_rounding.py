"""Readings that are rounded alike, against closed forms: the offset of a sensor by n equal readings."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.rounding import with_shared_rounding
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.profile import profiles

SD_A = 0.01


@pytest.fixture
def rounded(evidence_of, hypothesis, effect):
    """A fit of the offset to readings that are rounded to a step, whose noise is 10 mA."""
    model = hypothesis.with_effect(effect("current_sensor_offset"))

    def found(readings, step_A, x=0.0):
        evidence = evidence_of(x + np.zeros(len(readings)), readings)
        (stage,) = evidence.stages
        stage.observed = (replace(stage.observed[0], resolution=step_A),)
        evidence = Evidence((stage,))
        (fit,) = fits(evidence, [(model, model.null())])
        return evidence, with_shared_rounding(evidence, fit), model.effects[0]

    return found


@pytest.mark.parametrize("n", [10, 200])
def test_equal_readings_say_no_more_than_one(rounded, n):
    """Noise of a tenth of a step: all are 0.1 A, and the offset is anything from 0.05 to 0.15."""
    evidence, fit, offset = rounded(np.full(n, 0.1), step_A=0.1)
    uncertain = np.sqrt(0.1**2 / 12.0 * (1.0 - 1.0 / n) + SD_A**2 / n)
    assert fit.std(offset)["offset_A"] == pytest.approx(uncertain, rel=0.02)
    narrow, wide = profiles(evidence, fit)["current_sensor_offset"]["offset_A"]
    assert 0.5 * (narrow.high - narrow.low) == pytest.approx(uncertain, rel=0.1)
    assert 0.5 * (wide.high - wide.low) == pytest.approx(1.96 * uncertain, rel=0.1)


def test_readings_on_two_steps_have_two_errors_of_rounding(rounded):
    """So few that the tolerance of the gain does not matter: the mean of two, each of four equal readings."""
    _, fit, offset = rounded(np.repeat([0.1, 0.2], 4), step_A=0.1, x=np.repeat([0.0, 0.1], 4))
    uncertain = np.sqrt(0.1**2 / 12.0 / 2.0 * (1.0 - 1.0 / 4.0) + SD_A**2 / 8.0)
    assert fit.std(offset)["offset_A"] == pytest.approx(uncertain, rel=0.05)


def test_noise_that_dithers_makes_every_reading_count(rounded):
    readings = np.random.default_rng(1).normal(0.1, SD_A, 100)
    _, fit, offset = rounded(np.round(readings, 2), step_A=0.01)
    assert fit.std(offset)["offset_A"] == pytest.approx(SD_A / 10.0, rel=0.15)
