"""Where the search for an effect begins."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.scan import _tried, scan, scan_pairs, starts


@pytest.mark.parametrize("size_A", [1.0, 0.06, 40.0])
def test_limits_are_tried_between_the_samples_whatever_their_size(evidence_of, effect, size_A):
    """Currents are even from -1 to 1 times a size, so that a share of them is below the same share of the size."""
    x = np.linspace(-size_A, size_A, 1000)
    (tried,) = _tried(evidence_of(x, x, heldout=0), effect("current_limit"))
    shares = np.exp(tried) / size_A
    assert shares.min() == pytest.approx(0.2, abs=0.01)
    assert shares.max() == pytest.approx(0.997, abs=0.002)
    assert np.diff(np.sort(shares))[-6:].max() < 0.04


@pytest.mark.parametrize("size_A", [0.06, 1.0, 40.0])
def test_a_limit_is_visible_in_samples_of_any_size(evidence_of, effect, size_A):
    """A limit may lie below the largest sample even if its usual value, here 0.8 A, lies above all samples."""
    x = np.linspace(-size_A, size_A, 1000)
    (start,) = starts(evidence_of(x, x, heldout=0), effect("current_limit"))
    assert np.exp(start) < 0.9 * size_A


def test_two_effects_that_compensate_each_other_are_expected_together(evidence_of, hypothesis, effect):
    """About a current of 1 A, a gain of 1.1 and an offset of -0.1 A only turn the line of the readings."""
    x = np.linspace(0.8, 1.2, 60)
    gain, offset = effect("current_sensor_gain"), effect("current_sensor_offset")
    evidence = evidence_of(x, 1.1 * x - 0.1)
    (base,) = fits(evidence, [(hypothesis, hypothesis.null())])
    alone = scan(evidence, base, [gain, offset])
    (pair,) = scan_pairs(evidence, base, [gain, offset])
    assert pair.hypothesis.effects == (gain, offset)
    assert pair.drop > sum(prospect.drop for prospect in alone)
    values = [pair.hypothesis.values(each, pair.start) for each in (gain, offset)]
    assert values[0]["gain"] == pytest.approx(1.1, abs=0.02)
    assert values[1]["offset_A"] == pytest.approx(-0.1, abs=0.02)


def test_one_effect_makes_no_pair_with_itself(evidence_of, hypothesis, effect):
    x = np.linspace(-1.0, 1.0, 60)
    evidence = evidence_of(x, 1.4 * x)
    (base,) = fits(evidence, [(hypothesis, hypothesis.null())])
    assert scan_pairs(evidence, base, [effect("current_sensor_gain")]) == []


def test_a_small_play_is_tried(step_log, effect):
    """The change by a play is far from a straight line of its size, so that a large one says nothing about it."""
    evidence, nominal = step_log(1, gear_backlash={"gap_rad": 0.003})
    first, *_ = scan(evidence, nominal, [effect("gear_backlash"), effect("current_sensor_gain")])
    assert first.effect == effect("gear_backlash")
    assert first.drop > 15.0


def test_beside_a_play_a_fit_starts_with_an_effect_in_the_place_of_a_nominal_number(step_log, effect):
    """Contacts in the gear come and go with the smallest changes, so that slopes would not lead there.

    The square of the tolerances by which the number is off is the most by which the cost can fall.
    """
    evidence, nominal = step_log(3, gear_backlash={"gap_rad": 0.03}, coulomb_friction_scale={"scale": 1.35})
    gear, friction = effect("gear_backlash"), effect("coulomb_friction_scale")
    (play,) = scan(evidence, nominal, [gear])
    (fit,) = fits(evidence, [(nominal.hypothesis.with_effect(gear), play.start)])
    (coulomb,) = (k for k, each in enumerate(fit.hypothesis.nuisances) if "coulomb" in each.name)
    assert fit.x[coulomb] > 5.0
    (prospect,) = scan(evidence, fit, [friction])
    assert 15.0 < prospect.drop < fit.x[coulomb] ** 2
    assert abs(prospect.start[coulomb]) < 2.0
    (both,) = fits(evidence, [(fit.hypothesis.with_effect(friction), prospect.start)])
    assert fit.cost - both.cost > 15.0
