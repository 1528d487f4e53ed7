"""What an ideal test could see of the independent cases, against the normal distribution."""

from statistics import NormalDist

import pytest

from benchmarks.diagnosis.independent_cases.bound import FALSE_ALARMS, missed


@pytest.mark.parametrize(("ratio", "names"), [(30.0, 20), (12.0, 5), (3000.0, 50)])
def test_an_effect_with_one_number_is_missed_as_by_a_normal_test_with_two_tails(ratio, names):
    normal = NormalDist()
    limit = normal.inv_cdf(1.0 - FALSE_ALARMS / names / 2.0)
    expected = normal.cdf(limit - ratio**0.5) - normal.cdf(-limit - ratio**0.5)
    effect = {"parameters": {"scale": 1.1, "material": "wood"}, "lr": ratio}
    assert missed(effect, names) == pytest.approx(expected, abs=1e-9)
