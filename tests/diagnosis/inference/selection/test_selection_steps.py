"""Single steps of the selection of effects: from which fall an effect is named, and what is compared with what."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import at, fits
from diagnosis.inference.selection import stepwise as module
from diagnosis.inference.selection.refusal import (
    CLEAR,
    heldout_falls,
    is_far_below_a_row,
    is_negligible,
    needed,
    refusal,
)
from diagnosis.inference.selection.removal import cancelled_by, without
from diagnosis.inference.selection.scan import Prospect
from diagnosis.inference.selection.stepwise import (
    Entry,
    Selection,
    _best_pair,
    _is_better,
    _other_pairs,
    _pairs,
    _pruned,
    _starts,
    _swapped,
    promising,
    ranked,
    replaced,
    select,
)

SD_A = 0.01
X = np.linspace(-1.0, 1.0, 120)


@pytest.fixture
def fitted(hypothesis, effect):
    """Fit the nominal bench with the named effects, from where they are absent."""

    def fitted(evidence, *names):
        model = hypothesis
        for name in names:
            model = model.with_effect(effect(name))
        (fit,) = fits(evidence, [(model, model.null())])
        return fit

    return fitted


@pytest.mark.parametrize(("squares", "is_named"), [(14.5, False), (19.0, True)])
def test_an_effect_is_named_from_a_fall_of_15_on(evidence_of, hypothesis, effect, squares, is_named):
    """An offset of z sigmas in n rows of unit noise lowers the sum of squares n + n z^2 to n; X is orthogonal to it.

    With the level of the noise fitted, the fall is n times the logarithm of the ratio of both sums.
    """
    offset = SD_A * np.sqrt(squares / len(X))
    readings = X + offset + SD_A * (-1.0) ** np.arange(len(X))
    selection = select(evidence_of(X, readings), hypothesis, [effect("current_sensor_offset")])
    assert selection.names == (("current_sensor_offset",) if is_named else ())
    (entry,) = selection.entries
    assert entry.drop == pytest.approx(len(X) * np.log1p(squares / len(X)), rel=0.12)
    assert entry.accepted is is_named


def test_each_further_parameter_needs_3_more(effect):
    assert needed(effect("current_sensor_offset")) == 15.0
    assert needed(effect("friction_warmup")) == 18.0
    assert needed(effect("friction_warmup"), 9.0) == 12.0
    assert needed(effect("noise_scale")) == 9.0  # three standard errors: there are two effects of the noise


def test_an_effect_is_replaced_by_all_others_beside_those_that_stay(evidence_of, fitted, effect):
    gain, offset, scale = (effect(f) for f in ("current_sensor_gain", "current_sensor_offset", "torque_constant_scale"))
    evidence = evidence_of(X, 1.4 * X + 0.05)
    fit = fitted(evidence, gain.name, offset.name)
    rivals = replaced(evidence, fit, gain, without(evidence, fit, gain), [gain, offset, scale])
    assert [rival.hypothesis.effects for rival in rivals] == [(offset, scale)]


@pytest.mark.parametrize("name", ["current_sensor_gain", "current_sensor_offset", "current_limit"])
@pytest.mark.parametrize(("share", "expected"), [(0.0099, True), (0.0101, False), (-0.0099, True), (-0.0101, False)])
def test_an_effect_counts_from_a_hundredth_of_the_way_from_none_to_its_start(
    evidence_of, fitted, effect, name, share, expected
):
    """A limit is absent at its upper bound, others at a factor of 1 or at 0."""
    fit, (c,) = fitted(evidence_of(X, X), name), effect(name).coordinates
    at = replace(fit, x=np.array([0.3, c.null + share * (c.start - c.null)]))
    assert is_negligible(at, effect(name)) is expected


@pytest.mark.parametrize(("delay_s", "expected"), [(0.49e-4, True), (0.51e-4, False)])
@pytest.mark.parametrize("name", ["input_delay", "actuator_lag", "speed_filter_lag", "speed_time_offset"])
def test_a_delay_or_lag_counts_from_a_hundredth_of_a_row_on(step_log, effect, name, delay_s, expected):
    """A row of a step log lasts 5 ms. Four effects that hardly differ there count from the same time on."""
    evidence, nominal = step_log(1)
    late = nominal.hypothesis.with_effect(effect(name))
    x = late.null()
    x[late.parameters(effect(name))] = delay_s / effect(name).coordinates[0].unit
    assert is_negligible(at(evidence, late, x), effect(name)) is expected


@pytest.mark.parametrize(
    ("name", "delay_s", "expected"),
    [
        ("actuator_lag", 2.4e-4, True),
        ("input_delay", 2.4e-4, True),
        ("input_delay", 2.6e-4, False),
        ("current_sensor_gain", 1e-4, False),
    ],
)
def test_times_below_a_twentieth_of_a_row_are_far_below_it(step_log, effect, name, delay_s, expected):
    """A row of a step log lasts 5 ms."""
    evidence, nominal = step_log(1)
    late = nominal.hypothesis.with_effect(effect(name))
    x = late.null()
    x[late.parameters(effect(name))] += delay_s / effect(name).coordinates[0].unit
    assert is_far_below_a_row(at(evidence, late, x), effect(name)) is expected


def test_any_size_counts_in_rows_that_are_states(evidence_of, fitted, effect):
    """They have no errors of an integration."""
    offset = effect("current_sensor_offset")
    fit, (c,) = fitted(evidence_of(X, X), offset.name), offset.coordinates
    states: Any = SimpleNamespace(observed=[SimpleNamespace(is_series=False)])
    assert not is_negligible(replace(fit, evidence=states, x=np.array([0.3, c.null + 1e-4])), offset)


@pytest.mark.parametrize(
    ("name", "size"),
    [("battery_decline", 0.01 / 60.0), ("pose_clock_drift", 10e-6)],
    ids=["a battery that loses 1 % in an hour", "a quartz that is off by 10 ppm"],
)
def test_any_size_counts_of_an_effect_that_grows_with_time(evidence_of, fitted, effect, name, size):
    """The steps of an integration make the same error at the beginning and at the end of a session."""
    fit, drifting = fitted(evidence_of(X, X), "current_sensor_offset"), effect(name)
    (c,) = drifting.coordinates
    hypothesis = fit.hypothesis.without(effect("current_sensor_offset")).with_effect(drifting)
    of_drive = replace(fit, hypothesis=hypothesis, x=np.array([0.3, c.coordinate(size)]))
    assert not is_negligible(of_drive, drifting)


@pytest.mark.parametrize(
    ("drops", "count"),
    [
        ([100.0, 80.0, 72.0, 71.0, 70.5, 70.0, 69.9, 5.0], 6),
        ([20.0, 10.0, 6.0, 4.1, 4.1], 4),
        ([20.0, 4.0, 3.0], 1),
        ([], 0),
    ],
)
def test_four_effects_are_tried_and_those_that_are_nearly_as_promising(drops, count):
    prospects: Any = [SimpleNamespace(drop=drop) for drop in drops]
    assert [prospect.drop for prospect in promising(prospects)] == drops[:count]


def test_fits_are_ranked_by_their_cost_with_6_for_each_parameter_then_by_the_order_of_the_library(effect):
    one, two = effect("current_sensor_gain"), effect("friction_warmup")
    other = effect("current_sensor_offset")

    def fit(cost, *effects) -> Any:
        return SimpleNamespace(cost=cost, hypothesis=SimpleNamespace(effects=effects))

    fits_by_cost = [fit(13.9, two), fit(20.0, one), fit(19.0, other), fit(14.1, two), fit(1.0, two, one)]
    order = [f.cost for f in ranked(fits_by_cost, [one, two, other])]
    assert order == [1.0, 19.0, 13.9, 20.0, 14.1]
    equal = [fit(20.0, other), fit(20.04, one), fit(14.01, two)]
    assert [f.cost for f in ranked(equal, [one, two, other])] == [20.04, 14.01, 20.0]


@pytest.mark.parametrize(("rows", "reason"), [(7, "fewer than 8 samples"), (8, "")])
def test_with_fewer_than_8_samples_nothing_is_named(evidence_of, fitted, effect, rows, reason):
    x = np.linspace(-1.0, 1.0, rows)
    evidence = evidence_of(x, x + 3.0 * SD_A)
    before, after = fitted(evidence), fitted(evidence, "current_sensor_offset")
    assert refusal(evidence, before, after, effect("current_sensor_offset")) == reason


@pytest.mark.parametrize(("heldout", "is_refused"), [(5, False), (9, True)])
def test_held_out_rows_speak_against_an_effect_from_a_rise_of_8_on(evidence_of, fitted, effect, heldout, is_refused):
    """In n held-out rows without the offset, which is one standard deviation, the cost rises by n."""
    x = np.concatenate([X, np.zeros(heldout)])
    readings = np.concatenate([X + SD_A, np.zeros(heldout)])
    evidence = evidence_of(x, readings, heldout=heldout)
    before, after = fitted(evidence), fitted(evidence, "current_sensor_offset")
    reason = refusal(evidence, before, after, effect("current_sensor_offset"))
    assert reason.startswith("the cost of the held-out rows rises by") is is_refused
    assert bool(reason) is is_refused


def test_outliers_among_the_held_out_rows_do_not_speak_against_an_effect(evidence_of, fitted, effect):
    """It changes three rows of the fit. Without it, these are outliers, and others cost less."""
    x = np.where(np.arange(105) % 30 == 5, 1.0, 0.0)
    x[90:] = 0.0
    readings = 1.3 * x + 0.01 * np.random.default_rng(6).standard_normal(105)
    readings[[93, 97, 101]] += 0.5
    evidence = evidence_of(x, readings, heldout=15)
    before, after = fitted(evidence), fitted(evidence, "current_sensor_gain")
    assert float((before.costs - after.costs)[evidence.heldout].sum()) < -CLEAR
    assert float(heldout_falls(evidence, before, after, effect("current_sensor_gain")).sum()) == pytest.approx(
        0.0, abs=0.5
    )


def test_an_effect_that_lowers_the_cost_too_little_is_taken_out_again(evidence_of, fitted):
    both = ("current_sensor_gain", "current_sensor_offset")
    needless = evidence_of(X, 1.4 * X)
    assert _pruned(needless, fitted(needless, *both)).hypothesis.effects[0].name == both[0]
    assert len(_pruned(needless, fitted(needless, *both)).hypothesis.effects) == 1
    needful = evidence_of(X, 1.4 * X + 0.05)
    assert len(_pruned(needful, fitted(needful, *both)).hypothesis.effects) == 2
    assert len(_pruned(evidence_of(X, X), fitted(evidence_of(X, X), both[0])).hypothesis.effects) == 1


def test_an_earlier_effect_gives_way_to_one_that_explains_more(evidence_of, fitted, effect):
    """The limit of the current does nothing on this bench; the gain is what is hidden."""
    names = ("current_limit", "current_sensor_offset", "current_sensor_gain")
    evidence = evidence_of(X, 1.4 * X + 0.05)
    swapped = _swapped(evidence, fitted(evidence, *names[:2]), [effect(name) for name in names])
    assert [e.name for e in swapped.hypothesis.effects] == ["current_sensor_offset", "current_sensor_gain"]
    alone = fitted(evidence, "current_limit")
    assert _swapped(evidence, alone, [effect(name) for name in names]) is alone


@pytest.mark.parametrize(
    ("names", "drop", "is_better"),
    [
        (["current_sensor_gain"], 14.9, False),
        (["current_sensor_gain"], 15.1, True),
        (["current_sensor_gain", "current_limit"], -0.1, False),
        (["current_sensor_gain", "current_limit"], 0.1, True),
        (["current_sensor_gain", "friction_warmup"], -6.1, False),
        (["current_sensor_gain", "friction_warmup"], -5.9, True),
        (["current_sensor_gain", "torque_constant_scale", "current_limit"], -27.1, False),
        (["current_sensor_gain", "torque_constant_scale", "current_limit"], -26.9, True),
    ],
)
def test_a_pair_needs_15_more_than_a_single_effect_and_6_for_each_parameter_more_than_another_pair(
    evidence_of, fitted, names, drop, is_better
):
    """Three effects need 15 and 12 more than a pair."""
    evidence = evidence_of(X, X)
    pair = replace(fitted(evidence, "current_sensor_gain", "current_sensor_offset"), cost=100.0)
    assert _is_better(pair, replace(fitted(evidence, *names), cost=100.0 + drop)) is is_better


def test_the_best_pair_stays_what_it_is_and_a_pair_that_is_refused_is_none(evidence_of, fitted, effect):
    names = ("current_sensor_gain", "current_sensor_offset")
    effects = [effect(name) for name in names]
    evidence = evidence_of(X, 1.4 * X + 0.05)
    best = fitted(evidence, *names)
    base = fitted(evidence)
    assert _best_pair(evidence, base, _pairs(evidence, base, effects), best) is best
    found = _best_pair(evidence, base, _pairs(evidence, base, effects), fitted(evidence, names[1]))
    assert {e.name for e in found.hypothesis.effects} == set(names)
    # Held-out rows without the offset refuse it, however much it explains of the others.
    middle = X[45:75]
    contradicted = evidence_of(
        np.concatenate([X, middle]), np.concatenate([1.4 * X + 0.05, 1.4 * middle]), heldout=len(middle)
    )
    alone, base = fitted(contradicted, names[0]), fitted(contradicted)
    assert _best_pair(contradicted, base, _pairs(contradicted, base, effects), alone) is alone


def test_of_many_samples_two_effects_that_only_together_replace_two_others_are_tried(evidence_of, fitted, effect):
    """Two factors of the sensors imitate two numbers of the motor better than one factor beside one number does."""
    x = np.linspace(-1.0, 1.0, 600)
    evidence = evidence_of(x, 1.4 * x + 0.05)
    effects = [
        effect(name) for name in ("current_sensor_gain", "current_sensor_offset", "current_limit", "stribeck_friction")
    ]
    base, wrong = fitted(evidence), fitted(evidence, "current_limit", "stribeck_friction")
    (pair,) = _other_pairs(evidence, base, wrong, effects)
    assert [each.name for each in pair.hypothesis.effects] == ["current_sensor_gain", "current_sensor_offset"]
    assert _best_pair(evidence, base, [pair], wrong) is pair
    assert _other_pairs(evidence, base, fitted(evidence, "current_limit"), effects) == []


def test_a_pair_whose_effects_cancel_gives_way_to_any_other(evidence_of, fitted, monkeypatch):
    names = ("current_sensor_gain", "current_sensor_offset")
    evidence = evidence_of(X, 1.4 * X + 0.05)
    base, alone, best = fitted(evidence), fitted(evidence, names[0]), fitted(evidence, *names)
    monkeypatch.setattr(module, "cancelled_by", lambda _, __, fit, ___: "other" if fit is best else "")
    assert _best_pair(evidence, base, [best], alone) is alone
    other = fitted(evidence, "torque_constant_scale", names[1])
    assert _best_pair(evidence, base, [best, other], alone) is other
    assert _best_pair(evidence, base, [best, other], best) is other
    assert _best_pair(evidence, base, [best], best) is best


@pytest.mark.parametrize(("offset_A", "other"), [(-0.42, "current_sensor_offset"), (-0.3, "")])
def test_effects_cancel_if_they_leave_a_small_difference_that_neither_explains_alone(
    evidence_of, hypothesis, effect, offset_A, other
):
    """A gain of 1.4 and an offset leave 0 on average, or 0.12 A, of which a gain of 1.11 explains nearly all."""
    x = np.linspace(1.0, 1.1, 120)
    evidence = evidence_of(x, 1.4 * x + offset_A)
    gain, nominal = effect("current_sensor_gain"), replace(hypothesis, nuisances=())
    pair = nominal.with_effect(gain).with_effect(effect("current_sensor_offset"))
    base, both = fits(evidence, [(model, model.null()) for model in (nominal, pair)])
    assert cancelled_by(evidence, base, both, gain) == other


def test_of_two_pairs_held_out_rows_do_not_choose(evidence_of, fitted):
    names = ("current_sensor_gain", "current_sensor_offset")
    evidence = evidence_of(X, 1.4 * X + 0.05, heldout=30)
    best = fitted(evidence, *names)
    worse = replace(best, cost=best.cost + 1.0, z=np.where(evidence.heldout, 0.0, best.z))
    assert not _is_better(worse, best)
    assert not _is_better(worse, replace(best, z=np.where(evidence.heldout, 1.0, best.z)))


def test_two_effects_that_explain_as_much_as_three_others_take_their_place(
    evidence_of, fitted, hypothesis, effect, monkeypatch
):
    names = ("current_sensor_gain", "current_sensor_offset")
    evidence = evidence_of(X, 1.4 * X + 0.05)
    three = replace(
        fitted(evidence, "current_limit", "stribeck_friction", names[1]), cost=fitted(evidence, *names).cost
    )
    steps = iter([(three, [])])
    monkeypatch.setattr(module, "grown", lambda _, __, fit, ___: next(steps, (fit, [])))
    effects = [effect(name) for name in (*names, "current_limit", "stribeck_friction")]
    chosen = select(evidence, hypothesis, effects)
    assert set(chosen.names) == set(names)


def test_no_pairs_are_tried_where_no_effect_is_needed(evidence_of, hypothesis, effect, monkeypatch):
    grown: Any = SimpleNamespace(hypothesis=SimpleNamespace(effects=()))
    monkeypatch.setattr(module, "grown", lambda *_: (grown, []))
    monkeypatch.setattr(module, "_best_pair", lambda *_: pytest.fail("pairs were tried"))
    monkeypatch.setattr(module, "_pairs", lambda *_: pytest.fail("pairs were tried"))
    assert select(evidence_of(X, X), hypothesis, [effect("current_sensor_gain")]).fit is grown


@pytest.mark.parametrize(("samples", "searches_all"), [(2000, True), (2001, False)])
def test_all_pairs_are_searched_with_up_to_2000_samples(
    evidence_of, hypothesis, effect, monkeypatch, samples, searches_all
):
    searched = []
    one: Any = SimpleNamespace(hypothesis=SimpleNamespace(effects=(1,)))
    monkeypatch.setattr(module, "grown", lambda *_: (one, []))
    monkeypatch.setattr(module, "_pairs", lambda *_: searched.append("all") or [])
    monkeypatch.setattr(module, "_other_pairs", lambda *_: searched.append("in the place of two") or [])
    x = np.linspace(-1.0, 1.0, samples + 30)
    select(evidence_of(x, x, heldout=30), hypothesis, [effect("current_sensor_gain")])
    assert searched == ["all" if searches_all else "in the place of two"]


def test_no_pair_begins_with_an_effect_that_alone_explains_nothing(evidence_of, fitted, effect):
    evidence = evidence_of(X, 1.4 * X)
    effects = [effect(name) for name in ("current_sensor_gain", "current_sensor_offset")]
    assert _pairs(evidence, fitted(evidence), effects) == []


@pytest.mark.parametrize(("lower", "is_first"), [(0.04, True), (0.3, False), (41.0, False)])
def test_the_pair_of_the_lowest_cost_is_the_best_and_of_equal_ones_the_first(
    evidence_of, fitted, monkeypatch, lower, is_first
):
    """Costs are rounded to tenths, so that equal ones keep their order on every machine."""
    evidence = evidence_of(X, 1.4 * X + 0.05)
    monkeypatch.setattr(module, "refusal", lambda *_: "")
    monkeypatch.setattr(module, "_cancels", lambda *_: False)
    first = replace(fitted(evidence, "current_sensor_gain", "current_sensor_offset"), cost=100.0)
    second = replace(fitted(evidence, "torque_constant_scale", "current_sensor_offset"), cost=100.0 - lower)
    alone = replace(fitted(evidence, "current_sensor_gain"), cost=200.0)
    best = _best_pair(evidence, fitted(evidence), [first, second], alone)
    assert best is (first if is_first else second)


@pytest.mark.parametrize(("tolerances", "numbers"), [(2.9, [0.5, 0.5]), (3.0, [0.5, 0.5, 1.0, 0.5])])
def test_where_nuisances_imitate_an_effect_a_fit_also_starts_without_them_and_with_twice_the_delay(
    hypothesis, effect, tolerances, numbers
):
    x = np.full(len(hypothesis.nuisances), tolerances)
    prospects = [Prospect(effect(name), np.append(x, 0.5), 20.0) for name in ("input_delay", "current_sensor_offset")]
    starts = _starts(cast("Any", SimpleNamespace(hypothesis=hypothesis, x=x)), prospects)
    assert [start[-1] for _, start in starts] == numbers
    assert all(not start[:-1].any() for _, start in starts[2:])


def test_a_start_without_nuisances_keeps_the_effects_of_the_fit(hypothesis, effect):
    """Nuisances are 0 there, and the new delay is twice as long; the number of the effect before stays."""
    fit: Any = SimpleNamespace(
        hypothesis=hypothesis.with_effect(effect("current_sensor_offset")), x=np.array([3.0, 0.7])
    )
    _, (_, start) = _starts(fit, [Prospect(effect("input_delay"), np.array([3.0, 0.7, 0.5]), 20.0)])
    assert start.tolist() == [0.0, 0.7, 1.0]


def test_a_selection_and_its_steps_cannot_be_changed(changeable):
    for kind in (Entry, Selection):
        assert changeable(kind) == []
