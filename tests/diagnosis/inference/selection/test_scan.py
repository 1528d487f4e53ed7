"""Where the search for an effect begins."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.scan import _tried, scan, scan_pairs


@pytest.mark.parametrize("size_A", [1.0, 0.06, 40.0])
def test_limits_are_tried_between_the_samples_whatever_their_size(evidence_of, effect, size_A):
    """Currents are even from -1 to 1 times a size, so that a share of them is below the same share of the size."""
    x = np.linspace(-size_A, size_A, 1000)
    (tried,) = _tried(evidence_of(x, x, heldout=0), effect("current_limit"))
    shares = np.exp(tried) / size_A
    assert shares.min() == pytest.approx(0.2, abs=0.01)
    assert shares.max() == pytest.approx(0.997, abs=0.002)
    assert np.diff(np.sort(shares))[-6:].max() < 0.04


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
