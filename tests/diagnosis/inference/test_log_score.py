"""The log score of held-out readings: closed forms for normal noise whose standard deviation is known."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import norm

from diagnosis.inference.log_score import log_score_change

X = np.linspace(0.5, 1.0, 400)


def cost_of(z, sd):
    return -2.0 * norm.logpdf(z, scale=sd)


@pytest.fixture
def fit():
    """A fit of which only the costs of the readings are used."""

    def of(costs) -> Any:
        return type("Fit", (), {"costs": costs})

    return of


def test_only_held_out_readings_count(evidence_of, fit):
    costs = np.concatenate([np.full(360, 50.0), np.full(40, 3.0)])
    change = log_score_change(evidence_of(X, X, heldout=40), fit(costs), fit(np.full(400, 1.0)))
    assert change is not None
    assert (change.value, change.low, change.high) == pytest.approx((1.0, 1.0, 1.0))


def test_the_interval_covers_what_noise_of_twice_the_size_gives(evidence_of, fit):
    """For readings with a standard deviation of 2, log p at 2 less log p at 1 has the mean (4 - 1)/2 - log 2."""
    expected = 1.5 - np.log(2.0)
    inside = 0
    for seed in range(40):
        z = 2.0 * np.random.default_rng(seed).standard_normal(400)
        evidence = evidence_of(X, X + 0.01 * z, heldout=300, trials=40)
        change = log_score_change(evidence, fit(cost_of(z, 1.0)), fit(cost_of(z, 2.0)))
        assert change is not None
        inside += change.low <= expected <= change.high
    assert inside >= 32


def test_without_held_out_readings_there_is_none(evidence_of, fit):
    assert log_score_change(evidence_of(X, X, heldout=0), fit(X), fit(X)) is None
