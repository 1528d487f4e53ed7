import numpy as np

from diagnosis.inference.fit import fits
from diagnosis.inference.selection import is_at_bound, refusal

SD_A = 0.01
X = np.linspace(0.3, 1.0, 60)


def test_an_effect_that_would_have_to_be_larger_than_it_can_be_is_not_believed(evidence_of, hypothesis, effect):
    """A gain of 30: the term ends far below, and what is left is another's work."""
    gain = effect("current_sensor_gain")
    model = hypothesis.with_effect(gain)
    for factor, expected in ((30.0, True), (1.3, False)):
        evidence = evidence_of(X, factor * X + SD_A * np.random.default_rng(1).standard_normal(60))
        before, after = (fits(evidence, [(of, of.null())])[0] for of in (hypothesis, model))
        assert is_at_bound(after, gain) == expected
        assert ("larger than it can be" in refusal(evidence, before, after, gain)) == expected
