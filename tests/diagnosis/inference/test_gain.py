import numpy as np
import pytest

from diagnosis.inference.gain import gain

SD_A = 0.01
X = np.linspace(0.5, 1.0, 100)


def test_errors_and_gain_of_a_constant_offset(evidence_of, hypothesis, effect):
    """Readings 3 sigmas high: the nominal error is 3; with an offset of two of them in the model it is 1."""
    offset = effect("current_sensor_offset")
    model = hypothesis.with_effect(offset)
    extended = model.robot(np.array([0.0, 2.0 * SD_A / 0.03]))
    found = gain(evidence_of(X, X + 3.0 * SD_A, heldout=40), hypothesis.nominal, extended)
    assert (found.before, found.after, found.value) == pytest.approx((3.0, 1.0, 2.0 / 3.0))
    assert found.low == pytest.approx(found.high)


def test_rows_of_the_fit_and_the_largest_3_percent_do_not_count(evidence_of, hypothesis):
    readings = X + SD_A
    readings[:60] += 1.0
    readings[97] += 1.0
    found = gain(evidence_of(X, readings, heldout=40), hypothesis.nominal, hypothesis.nominal)
    assert found.before == pytest.approx(1.0)


def test_the_interval_covers_the_gain_of_fresh_rows(evidence_of, hypothesis, effect):
    """Normal noise about an offset of 3 sigmas that the model has; errors of 200,000 rows, trimmed alike."""
    model = hypothesis.with_effect(effect("current_sensor_offset"))
    extended = model.robot(np.array([0.0, 1.0]))
    inside = 0
    for seed in range(40):
        generator = np.random.default_rng(seed)
        x = generator.uniform(0.5, 1.0, 400)
        readings = x + 0.03 + SD_A * generator.standard_normal(400)
        found = gain(evidence_of(x, readings, heldout=300, trials=40), hypothesis.nominal, extended)
        large = np.random.default_rng(1).standard_normal(200_000)
        kept = [np.sort(np.abs(large + shift))[:194_000] for shift in (3.0, 0.0)]
        expected = 1.0 - np.sqrt(np.mean(kept[1] ** 2) / np.mean(kept[0] ** 2))
        inside += found.low <= expected <= found.high
    assert inside >= 32


def test_few_held_out_rows_of_one_stretch_still_give_an_interval(evidence_of, hypothesis, effect):
    model = hypothesis.with_effect(effect("current_sensor_offset"))
    readings = X + 0.03 + SD_A * np.random.default_rng(3).standard_normal(100)
    found = gain(evidence_of(X, readings, heldout=8), hypothesis.nominal, model.robot(np.array([0.0, 1.0])))
    assert found.low < found.value < found.high
