from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.gain import Gain, evidence_of_quantity, gain, gain_of, gain_of_sizes, row_blocks, trimmed_rms

SD_A = 0.01
X = np.linspace(0.5, 1.0, 100)


def gained(evidence, nominal, extended):
    found = gain(evidence, nominal, extended)
    assert found is not None
    return found


def test_errors_and_gain_of_a_constant_offset(evidence_of, hypothesis, effect):
    """Readings 3 sigmas high: the nominal error is 3; with an offset of two of them in the model it is 1."""
    offset = effect("current_sensor_offset")
    model = hypothesis.with_effect(offset)
    extended = model.robot(np.array([0.0, 2.0 * SD_A / 0.03]))
    found = gained(evidence_of(X, X + 3.0 * SD_A, heldout=40), hypothesis.nominal, extended)
    assert (found.before, found.after, found.value) == pytest.approx((3.0, 1.0, 2.0 / 3.0))
    assert found.low == pytest.approx(found.high)
    assert found.by_quantity == (("current_A", pytest.approx(3.0), pytest.approx(1.0)),)


def test_rows_of_the_fit_and_the_largest_3_percent_do_not_count(evidence_of, hypothesis):
    readings = X + SD_A
    readings[:60] += 1.0
    readings[97] += 1.0
    found = gained(evidence_of(X, readings, heldout=40), hypothesis.nominal, hypothesis.nominal)
    assert found.before == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("value", "low", "high", "is_unchanged"),
    [(0.0, 0.0, 0.0, True), (0.0, 0.0, 0.1, False), (0.0, -0.1, 0.0, False), (-1.0, -1.0, -1.0, False)],
)
def test_a_gain_of_0_without_an_interval_is_that_of_the_same_predictions(value, low, high, is_unchanged):
    assert Gain(value, low, high, 1.0, 1.0, ()).is_unchanged is is_unchanged


def test_the_interval_covers_the_gain_of_fresh_rows(evidence_of, hypothesis, effect):
    """Normal noise about an offset of 3 sigmas that the model has; errors of 200,000 rows, trimmed alike."""
    model = hypothesis.with_effect(effect("current_sensor_offset"))
    extended = model.robot(np.array([0.0, 1.0]))
    inside = 0
    for seed in range(40):
        generator = np.random.default_rng(seed)
        x = generator.uniform(0.5, 1.0, 400)
        readings = x + 0.03 + SD_A * generator.standard_normal(400)
        found = gained(evidence_of(x, readings, heldout=300, trials=40), hypothesis.nominal, extended)
        large = np.random.default_rng(1).standard_normal(200_000)
        kept = [np.sort(np.abs(large + shift))[:194_000] for shift in (3.0, 0.0)]
        expected = 1.0 - np.sqrt(np.mean(kept[1] ** 2) / np.mean(kept[0] ** 2))
        inside += found.low <= expected <= found.high
    assert inside >= 32


def test_few_held_out_rows_of_one_stretch_still_give_an_interval(evidence_of, hypothesis, effect):
    model = hypothesis.with_effect(effect("current_sensor_offset"))
    readings = X + 0.03 + SD_A * np.random.default_rng(3).standard_normal(100)
    found = gained(evidence_of(X, readings, heldout=8), hypothesis.nominal, model.robot(np.array([0.0, 1.0])))
    assert found.low < found.value < found.high


def test_without_rows_held_out_there_is_no_gain(evidence_of, hypothesis):
    evidence = evidence_of(X, X)
    assert gain(evidence, hypothesis.nominal, hypothesis.nominal) is None
    assert gain_of(evidence, np.zeros((2, 100))) is None


@pytest.mark.parametrize(("rows", "kept"), [(100, 97), (34, 32), (33, 32), (1, 1)])
def test_the_smallest_97_percent_count_and_at_least_one(rows, kept):
    sizes = np.random.default_rng(1).permutation(np.arange(1.0, rows + 1.0))
    # The mean of the squares 1 to n is (n + 1)(2 n + 1) / 6.
    assert trimmed_rms(sizes) ** 2 == pytest.approx((kept + 1) * (2 * kept + 1) / 6)


def test_the_error_of_several_stages_is_the_root_mean_square_of_theirs():
    blocks = np.arange(50)
    found = gain_of_sizes([(np.full((2, 50), 3.0), blocks), (np.tile([[4.0], [1.0]], 50), blocks)])
    assert (found.before, found.after) == pytest.approx((np.sqrt(12.5), np.sqrt(5.0)))
    assert found.value == found.low == found.high == pytest.approx(1.0 - np.sqrt(5.0 / 12.5))


def test_a_single_row_counts_whole_in_the_interval_too():
    found = gain_of_sizes([(np.array([[2.0], [1.0]]), np.zeros(1, int))])
    assert (found.before, found.after, found.value) == (2.0, 1.0, 0.5)
    both = gain_of_sizes([(np.array([[2.0], [1.0]]), np.zeros(1, int)), (np.full((2, 4), 2.0), np.zeros(4, int))])
    # Each draw of a single block is that block: the root of (1 + 4) / 2 over the root of (4 + 4) / 2.
    assert both.low == both.high == pytest.approx(1.0 - np.sqrt(2.5 / 4.0))


def test_half_of_an_error_below_the_noise_is_a_gain_of_a_half():
    found = gain_of_sizes([(np.tile([[0.4], [0.2]], 50), np.arange(50))])
    assert (found.value, found.low, found.high) == pytest.approx((0.5, 0.5, 0.5))


def test_a_model_without_any_error_is_not_improved():
    found = gain_of_sizes([(np.tile([[0.0], [2.0]], 50), np.arange(50))])
    assert (found.value, found.low, found.high) == (0.0, 0.0, 0.0)


def test_the_interval_is_that_of_a_bootstrap_over_blocks_written_out():
    """Kuensch (1989): as many blocks as there are, with replacement, and all of their rows."""
    sizes = np.abs(np.random.default_rng(4).normal([[2.0], [1.0]], 0.5, (2, 60)))
    blocks = np.repeat(np.arange(12), 5)
    found = gain_of_sizes([(sizes, blocks)])
    generator, gains = np.random.Generator(np.random.PCG64(2026)), []
    for _ in range(400):
        drawn = np.concatenate([sizes[:, blocks == block] for block in generator.integers(12, size=12)], axis=1)
        gains.append(1.0 - trimmed_rms(drawn[1]) / trimmed_rms(drawn[0]))
    assert (found.low, found.high) == pytest.approx((np.quantile(gains, 0.025), np.quantile(gains, 0.975)))


def timed(evidence, t_s):
    """The evidence with rows at other times."""
    (stage,) = evidence.stages
    (observed,) = stage.observed
    return Evidence((replace(stage, observed=(replace(observed, t_s=t_s),)),))


@pytest.mark.parametrize(
    ("period_s", "at_once", "rows"),
    [(0.05, 1, 40), (0.5, 1, 10), (3.0, 1, 10), (0.5, 2, 20)],
    ids=["2 s", "10 rows", "10 slow rows", "10 pairs of rows"],
)
def test_a_block_is_2_seconds_or_10_times_of_rows_whichever_is_longer(evidence_of, period_s, at_once, rows):
    x = np.linspace(0.0, 1.0, 400)
    t_s = period_s * (np.arange(400) // at_once)
    blocks = row_blocks(timed(evidence_of(x, x, heldout=300, trials=4), t_s))
    for trial in range(4):
        _, lengths = np.unique(blocks[100 * trial : 100 * (trial + 1)], return_counts=True)
        assert set(lengths[1:-1]) <= {rows}
    assert not set(blocks[:100]) & set(blocks[100:])


def test_no_block_has_rows_of_two_trials_with_the_same_times(evidence_of):
    """Four trials of 50 s from 0 on: 10 blocks of 5 s in each."""
    x = np.linspace(0.0, 1.0, 400)
    blocks = row_blocks(timed(evidence_of(x, x, heldout=300, trials=4), np.tile(0.5 * np.arange(100), 4)))
    names, rows = np.unique(blocks, return_counts=True)
    assert (len(names), set(rows)) == (40, {10})


def test_rows_that_all_have_one_time_are_drawn_singly(evidence_of):
    assert row_blocks(timed(evidence_of(X, X, heldout=40), np.zeros(100))).tolist() == list(range(100))


@pytest.mark.parametrize(("trials", "are_drawn_whole"), [(5, True), (4, False)])
def test_from_5_held_out_trials_on_whole_trials_are_drawn(evidence_of, trials, are_drawn_whole):
    x = np.linspace(0.0, 1.0, 400)
    evidence = evidence_of(x, x, heldout=400, trials=trials)
    assert np.array_equal(row_blocks(evidence), evidence.trial) is are_drawn_whole


@pytest.mark.parametrize(("heldout", "blocks"), [(41, 5), (40, 4)])
def test_with_fewer_than_5_blocks_single_rows_are_drawn(evidence_of, heldout, blocks):
    """Rows of 1 s in blocks of 10 from the first: the last 41 of 100 lie in 5 of them, the last 40 in 4."""
    evidence = evidence_of(X, X, heldout=heldout)
    assert len(np.unique(row_blocks(evidence)[evidence.heldout])) == (blocks if blocks == 5 else heldout)


def test_the_rows_of_one_quantity_are_held_out_at_its_place(evidence_of):
    one = evidence_of(X, X, heldout=40)
    both = Evidence((*one.stages, *evidence_of(X, X, heldout=10).stages))
    assert np.flatnonzero(evidence_of_quantity(both, both.places[1]).heldout).tolist() == list(range(190, 200))
    assert np.array_equal(evidence_of_quantity(both, both.places[1]).fit, both.fit)


def test_a_gain_cannot_be_changed(changeable):
    assert changeable(Gain) == []
