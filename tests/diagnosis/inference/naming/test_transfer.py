"""What each manoeuvre or range of speed says about an effect, on a bench where likelihoods are closed forms."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.naming.transfer import AGAINST, Support, contradiction, groups, supports, trial_groups

SD_A = 0.01
N = 120
X = np.zeros(N)


def support_of(evidence, hypothesis, effect, names):
    model = hypothesis.with_effect(effect)
    base, fit = fits(evidence, [(hypothesis, hypothesis.null()), (model, model.null())])
    (found,) = supports(evidence, fit, [base], groups(evidence, names))
    return {each.group: each.fall for each in found}


def noise(seed):
    return SD_A * np.random.default_rng(seed).standard_normal(N)


def test_an_offset_that_all_trials_share_is_supported_by_each_of_them(evidence_of, hypothesis, effect):
    """A reading of an offset with a known noise lowers the cost by the square of the offset in sigmas."""
    evidence = evidence_of(X, 0.03 + noise(1), trials=3)
    found = support_of(evidence, hypothesis, effect("current_sensor_offset"), ["a", "b", "c"])
    assert list(found) == ["trial 1", "trial 2", "trial 3"]
    assert all(fall > 40.0 for fall in found.values())


def test_trials_without_the_offset_speak_against_it(evidence_of, hypothesis, effect):
    offset = np.where(np.arange(N) < N // 3, 0.03, 0.0)
    evidence = evidence_of(X, offset + noise(2), trials=3)
    found = support_of(evidence, hypothesis, effect("current_sensor_offset"), ["arc/1", "line/1", "line/2"])
    assert found["line/*"] < -8.0
    assert found["arc/*"] > 0.0


@pytest.mark.parametrize("seed", range(5))
def test_trials_that_cannot_show_the_effect_say_nothing_against_it(evidence_of, hypothesis, effect, seed):
    """A gain changes nothing where no current flows."""
    x = np.where(np.arange(N) < N // 2, 1.0, 0.0)
    evidence = evidence_of(x, 1.5 * x + noise(seed), trials=2)
    found = support_of(evidence, hypothesis, effect("current_sensor_gain"), ["1", "2"])
    assert found["trial 2"] > -4.0


@pytest.mark.parametrize("seed", range(2))
def test_outliers_in_rows_without_the_effect_say_nothing_against_it(evidence_of, hypothesis, effect, seed):
    """The first of three trials has sixteen outliers; current flows only in twenty rows of the others.

    Without the effect these are outliers too. Among so many, each of the sixteen would cost less than with the effect.
    """
    rows = 300
    generator = np.random.default_rng(seed)
    x = np.where((np.arange(rows) >= 100) & (np.arange(rows) % 10 == 0), 1.0, 0.0)
    readings = 2.0 * x + SD_A * generator.standard_normal(rows)
    readings[:96:6] += 0.3 * generator.choice([-1.0, 1.0], 16)
    found = support_of(evidence_of(x, readings, trials=3), hypothesis, effect("current_sensor_gain"), ["1", "2", "3"])
    assert found["trial 1"] > -4.0


def test_names_up_to_the_slash_tell_manoeuvres_apart(evidence_of):
    evidence = evidence_of(X, X, trials=4)
    found = trial_groups(evidence, ["arc/1", "arc/2", "line/1", "line/2"], evidence.fit)
    assert [(group.name, np.flatnonzero(group.rows).tolist()) for group in found] == [
        ("arc/*", list(range(60))),
        ("line/*", list(range(60, 120))),
    ]


def test_many_trials_are_three_groups_in_their_order(evidence_of):
    evidence = evidence_of(X, X, trials=6)
    found = trial_groups(evidence, [str(k) for k in range(6)], evidence.fit)
    assert [group.name for group in found] == ["trials 1 to 2", "trials 3 to 4", "trials 5 to 6"]
    assert sum(group.rows for group in found).tolist() == [1] * N


def test_slow_and_fast_rows_are_groups_of_their_own(evidence_of):
    speed = np.linspace(-3.0, 3.0, N)
    evidence = evidence_of(X, X, omega_rad_s=speed)
    slow, fast = groups(evidence, ["1"])
    assert np.abs(speed[slow.rows]).max() < 1.01
    assert np.abs(speed[fast.rows]).min() > 1.99
    assert slow.name.startswith("omega_rad_s below 1.0")


def test_the_contradiction_names_the_group_that_contradicts_and_the_one_that_shows_the_effect():
    found = [Support("arc/*", 50.0), Support("line/*", -AGAINST - 1.0), Support("spin/*", 3.0)]
    assert contradiction(found, 45.0) == "line/* (it describes arc/*)"
    assert not contradiction([Support("arc/*", 50.0), Support("line/*", 1.0 - AGAINST)], 45.0)
    assert not contradiction([], 45.0)


def test_a_small_share_of_a_large_fall_is_no_contradiction():
    """Without some rows the noise is estimated a few per cent smaller, and so much larger is the whole fall."""
    found = [Support("far", 1300.0), Support("near", -1.5 * AGAINST)]
    assert not contradiction(found, 1000.0)
    assert contradiction(found, 100.0)
