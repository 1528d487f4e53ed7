import numpy as np

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.refusal import is_at_bound, refusal

SD_A = 0.01
X = np.linspace(0.3, 1.0, 60)


def test_an_effect_that_would_have_to_be_larger_than_it_can_be_is_not_believed(evidence_of, hypothesis, effect):
    """A gain of 30: the effect ends far below, and what is left is another's work."""
    gain = effect("current_sensor_gain")
    model = hypothesis.with_effect(gain)
    for factor, expected in ((30.0, True), (1.3, False)):
        evidence = evidence_of(X, factor * X + SD_A * np.random.default_rng(1).standard_normal(60))
        before, after = (fits(evidence, [(of, of.null())])[0] for of in (hypothesis, model))
        assert is_at_bound(after, gain) == expected
        assert ("would exceed its bounds" in refusal(evidence, before, after, gain)) == expected


def test_an_amplitude_within_its_error_of_the_end_of_its_range_is_at_that_end(evidence_of, hypothesis, effect):
    """K is known to 2 %, and so is the gain: 0.1 % below the highest is a twentieth of that, 10 % below is none."""
    gain = effect("current_sensor_gain")
    model = hypothesis.with_effect(gain)
    highest = float(np.exp(gain.coordinates[0].high))
    for share, expected in ((0.999, True), (0.9, False)):
        (fit,) = fits(evidence_of(X, share * highest * X), [(model, model.null())])
        assert fit.x[-1] < gain.coordinates[0].high
        assert is_at_bound(fit, gain) == expected


def test_an_effect_beside_which_another_would_have_to_be_larger_than_it_can_be_is_not_believed(
    evidence_of, hypothesis, effect
):
    """Alone the gain makes do with less; with an offset of -1 A it is 5 % more than it can be."""
    gain, offset = effect("current_sensor_gain"), effect("current_sensor_offset")
    highest = float(np.exp(gain.coordinates[0].high))
    evidence = evidence_of(X, 1.05 * highest * X - 1.0 + SD_A * np.random.default_rng(2).standard_normal(60))
    alone, both = hypothesis.with_effect(gain), hypothesis.with_effect(gain).with_effect(offset)
    before, after = (fits(evidence, [(of, of.null())])[0] for of in (alone, both))
    assert not is_at_bound(before, gain)
    assert refusal(evidence, before, after, offset) == "the size of current_sensor_gain would then exceed its bounds"
