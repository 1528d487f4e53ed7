"""The posterior predictive check: what the model leaves out shows, and what it has does not."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.posterior.predictive_check import (
    LEVEL,
    STATISTICS,
    CheckedStatistic,
    _coordinates,
    _noise,
    predictive_check,
)
from diagnosis.report.sentences.data.predictive import predictive_sentence
from symolo.core.random_streams import stream

ROWS = 4000


def test_statistics_of_normal_noise_are_those_of_the_normal_distribution():
    """A first-order process with the correlation 0.5; beyond 3 sd lies 0.27 %."""
    noise = stream(1, "noise").standard_normal(ROWS)
    for k in range(1, ROWS):
        noise[k] = 0.5 * noise[k - 1] + np.sqrt(0.75) * noise[k]
    values = {name: float(statistic(noise)) for name, statistic in STATISTICS.items()}
    assert values["median"] == pytest.approx(0.0, abs=0.1)
    assert values["half width of the middle 68 %"] == pytest.approx(1.0, abs=0.06)
    assert values["correlation of neighbours"] == pytest.approx(0.5, abs=0.05)
    assert values["share beyond 3 sd"] == pytest.approx(0.0027, abs=0.003)


def test_data_of_the_model_lie_inside_as_often_as_the_level_says(diagnosis_of):
    """The data are drawn at the fitted numbers, which are as certain as the noise allows: at most 5 % are outside."""
    diagnosis, rng = diagnosis_of("plain"), stream(3, "data")
    evidence, fit = diagnosis.evidence, diagnosis.fit
    checks = []
    for _ in range(25):
        values = evidence.values - fit.z * fit.sd + fit.sd * rng.standard_normal(len(fit.sd))
        drawn = replace(diagnosis, evidence=evidence.without(evidence.values - values))
        checks += predictive_check(drawn, 60)
    assert sum(each.is_outside for each in checks) / len(checks) < 0.08


def test_a_bump_that_has_no_name_lies_outside(diagnosis_of):
    checks = predictive_check(diagnosis_of("bumped"))
    widths = {each.quantity: each for each in checks if each.rows == "fitted" and each.name.startswith("half width")}
    assert widths["current_A"].is_outside
    assert widths["current_A"].share_below == 1.0
    assert not widths["omega_rad_s"].is_outside


def test_drawn_noise_has_the_outliers_of_the_fit_and_the_same_check_gives_the_same_numbers(diagnosis_of):
    diagnosis = diagnosis_of("plain")
    noise = _noise(diagnosis.fit, 400, stream(2, "noise"))
    share = diagnosis.fit.noise.shares[diagnosis.evidence.quantity].mean()
    # Nearly all outliers, of a Cauchy density of 10 sd, are beyond 3 sd: the share 1 - 2 atan(0.3) / pi.
    expected = 0.0027 + share * (1.0 - 2.0 * np.arctan(0.3 / diagnosis.fit.noise.levels.mean()) / np.pi)
    assert (np.abs(noise) > 3.0).mean() == pytest.approx(expected, rel=0.2)
    assert predictive_check(diagnosis, 20) == predictive_check(diagnosis, 20)


def test_the_sentence_counts_what_is_outside_and_what_chance_would_put_there(diagnosis_of):
    checks = predictive_check(diagnosis_of("bumped"))
    outside = sum(each.is_outside for each in checks)
    assert f"Of {len(checks)} statistics" in predictive_sentence(checks)
    assert f"{outside} lie outside {100 * LEVEL:g} % of the robots" in predictive_sentence(checks)


def checked(name, *shares_below):
    """Checks of one statistic of several quantities."""
    return [
        CheckedStatistic(f"q{k}", "fitted", name, 0.0, (0.0, 0.0, 0.0), share) for k, share in enumerate(shares_below)
    ]


@pytest.mark.parametrize(
    ("name", "share_below", "meaning"),
    [
        ("median", 1.0, "q0 and q1 are higher than predicted on average"),
        (
            "half width of the middle 68 %",
            0.0,
            "q0 and q1 scatter less than the fit assumes, so that",
        ),
        ("half width of the middle 68 %", 1.0, "q0 and q1 scatter more than the fit assumes"),
        ("correlation of neighbours", 0.0, "q0 and q1 alternate from row to row"),
        ("share beyond 3 sd", 1.0, "q0 and q1 have more large errors"),
    ],
)
def test_the_sentence_says_what_it_means_that_more_lie_outside_than_by_chance(name, share_below, meaning):
    text = predictive_sentence(checked(name, share_below, share_below, 0.5, 0.5))
    assert text.count("Outside means: ") == 1
    assert text.partition("Outside means: ")[2].startswith(meaning)


def test_what_chance_puts_outside_means_nothing():
    """Of 20 statistics, 1 is outside by chance, and 3 are less than two standard deviations more."""
    assert "means" not in predictive_sentence(checked("median", 1.0, 1.0, *[0.5] * 18))
    assert "means" in predictive_sentence(checked("median", 1.0, 1.0, 1.0, 1.0, *[0.5] * 16))


def test_draws_have_the_covariance_of_the_fit_whatever_the_signs_of_eigenvectors(monkeypatch):
    covariance = np.array([[4.0, 1.2, 0.0], [1.2, 1.0, 0.0], [0.0, 0.0, 0.0]])
    fit = SimpleNamespace(
        covariance=covariance, x=np.array([1.0, 2.0, 3.0]), hypothesis=SimpleNamespace(clipped=lambda x: x)
    )
    draws = _coordinates(fit, 20_000, np.random.default_rng(1))
    assert np.cov(draws.T) == pytest.approx(covariance, abs=0.12)
    assert draws.mean(axis=0) == pytest.approx(fit.x, abs=0.05)
    values, vectors = np.linalg.eigh(covariance)
    monkeypatch.setattr(np.linalg, "eigh", lambda _: (values, vectors * [-1.0, 1.0, -1.0]))
    again = _coordinates(fit, 20_000, np.random.default_rng(1))
    np.testing.assert_allclose(again, draws, rtol=1e-12)
