"""Every rule of the selection by itself, on fits that are given by their costs alone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from configs.effects.base import Slot
from diagnosis.inference.selection import refusal as refusals
from diagnosis.inference.selection import removal, rescue, stepwise
from diagnosis.inference.selection.rescue import rescued
from diagnosis.inference.selection.stepwise import Entry, Selection, select
from tests.diagnosis.inference.selection.known_fits import (
    NOISE,
    WIDE,
    A,
    B,
    C,
    D,
    Fake,
    FakeHypothesis,
    fake_effect,
    fake_fit,
)


@pytest.fixture
def evidence() -> Any:
    """More rows than those up to which all pairs are compared, in two stages: the steps alone decide."""
    return Fake(memo={}, fit=np.ones(stepwise.BEAM_SAMPLES + 1, dtype=bool), stages=("wheels", "pose"))


class TestSteps:
    """The order of the steps, on fits by a table of costs."""

    @pytest.fixture
    def refusing(self, monkeypatch):
        """Let these effects be refused, and list the thresholds by which they are judged."""

        def refuse(*effects):
            thresholds = []

            def refusal(_, __, ___, effect, threshold=refusals.THRESHOLD):
                thresholds.append((effect, threshold))
                return "no" if effect in effects else ""

            monkeypatch.setattr(stepwise, "refusal", refusal)
            monkeypatch.setattr(rescue, "refusal", refusal)
            return thresholds

        return refuse

    def test_steps_after_the_last_accepted_one_are_the_refused_ones(self):
        steps = [
            Entry(effect, 1.0, accepted, "") for effect, accepted in ((A, False), (B, True), (C, False), (D, False))
        ]
        fit = fake_fit(1.0)
        assert Selection(fit, fit, tuple(steps)).refused == tuple(steps[2:])
        assert Selection(fit, fit, tuple(steps[2:])).refused == tuple(steps[2:])
        assert Selection(fit, fit, tuple(steps[:2])).refused == ()

    @pytest.mark.parametrize(("cost_of_b", "tried"), [(85.0, "ABC"), (85.5, "AB")])
    def test_the_next_effects_are_tried_until_one_is_too_weak(self, evidence, monkeypatch, refusing, cost_of_b, tried):
        """Of costs that fall from 100, 15 less is strong enough."""
        refusing(A, B)
        candidates = [fake_fit(80.0, A), fake_fit(cost_of_b, B), fake_fit(84.0, C)]
        monkeypatch.setattr(stepwise, "extended", lambda *_: candidates)
        entered, entries = stepwise._entered(evidence, fake_fit(100.0), ())
        assert "".join(entry.effect.name for entry in entries) == tried
        assert entered is (candidates[2] if tried == "ABC" else None)
        assert [entry.accepted for entry in entries] == [False, False, True][: len(tried)]
        assert [entry.drop for entry in entries] == [20.0, 100.0 - cost_of_b, 16.0][: len(tried)]
        assert [entry.reason for entry in entries] == ["no", "no", "the cost falls by 16.0"][: len(tried)]

    def test_three_effects_are_enough_and_a_model_no_better_than_none_ends_the_selection(self, evidence, monkeypatch):
        fits_by_size = [fake_fit(100.0), fake_fit(80.0, A), fake_fit(60.0, A, B), fake_fit(40.0, A, B, C)]
        monkeypatch.setattr(stepwise, "without_effects", lambda *_: fits_by_size[0])
        grown = [0]

        def entered(_, fit, __):
            grown[0] += 1
            assert grown[0] <= 4  # instead of going on for ever
            return fits_by_size[len(fit.hypothesis.effects) + 1], ["step"]

        monkeypatch.setattr(stepwise, "_entered", entered)
        monkeypatch.setattr(stepwise, "_swapped", lambda _, fit, __: fit)
        monkeypatch.setattr(stepwise, "_pruned", lambda _, fit: fit)
        found = select(evidence, fits_by_size[0].hypothesis, ())
        assert (found.nominal, found.fit, len(found.entries)) == (fits_by_size[0], fits_by_size[3], 3)
        worse = fake_fit(100.0, D)
        monkeypatch.setattr(stepwise, "_pruned", lambda *_: worse)
        assert select(evidence, fits_by_size[0].hypothesis, ()).fit is worse
        assert grown[0] == 4

    @pytest.mark.parametrize("effects", [(A,), (A, NOISE)])
    def test_a_better_pair_replaces_the_effects_and_a_third_one_is_tried_beside_it(self, monkeypatch, effects):
        few: Any = Fake(memo={}, fit=np.ones(stepwise.BEAM_SAMPLES, dtype=bool))
        base, single = fake_fit(100.0), fake_fit(80.0, *effects)
        pair, three = fake_fit(40.0, B, C), fake_fit(20.0, B, C, D)
        alone = {B: fake_fit(75.0, C), C: fake_fit(90.0, B)}
        next_of = {base: (single, ["A enters"]), single: (None, ["B is refused"]), pair: (three, ["D enters"])}
        monkeypatch.setattr(stepwise, "without_effects", lambda *_: base)
        monkeypatch.setattr(stepwise, "_entered", lambda _, fit, __: next_of[fit])
        monkeypatch.setattr(stepwise, "_swapped", lambda _, fit, __: fit)
        monkeypatch.setattr(stepwise, "_pruned", lambda _, fit: fit)
        monkeypatch.setattr(stepwise, "without", lambda _, __, effect: alone[effect])
        monkeypatch.setattr(stepwise, "_pairs", lambda *_: [pair])
        monkeypatch.setattr(stepwise, "_best_pair", lambda *_: pair)
        found = select(few, base.hypothesis, ())
        assert found.fit is three
        assert found.pairs == (pair,)
        assert [(entry.effect, entry.drop, entry.accepted) for entry in found.entries[:2]] == [
            (B, 35.0, True),
            (C, 50.0, True),
        ]
        assert found.entries[2:] == ("D enters",)
        monkeypatch.setattr(stepwise, "_best_pair", lambda _, __, ___, fit: fit)
        assert select(few, base.hypothesis, ()).entries == ("A enters", "B is refused")

    def test_a_selection_goes_on_from_the_effects_of_an_earlier_one(self, evidence, monkeypatch):
        begin = Selection(fake_fit(90.0), fake_fit(50.0, A, B), (Entry(A, 1.0, accepted=True, reason=""),))
        started = []

        def fits(_, starts):
            started.extend(starts)
            return [fake_fit(70.0, *starts[0][0].effects)]

        for module in (stepwise, removal):
            monkeypatch.setattr(module, "fits", fits)
        monkeypatch.setattr(stepwise, "_entered", lambda *_: (None, ["step"]))
        nominal: Any = FakeHypothesis()
        found = select(evidence, nominal, (), begin)
        assert started == [(nominal, "null"), (begin.fit.hypothesis, "x of 50.0")]
        assert found.fit.hypothesis.effects == (A, B)
        assert found.entries == (*begin.entries, "step")
        started.clear()
        evidence.memo.clear()
        assert select(evidence, nominal, ()).fit.hypothesis.effects == ()
        assert started == [(nominal, "null")]

    def test_an_inadequate_model_is_rescued_by_the_first_accepted_effect_that_makes_it_adequate(
        self, evidence, monkeypatch, refusing
    ):
        """From a fall of 9 on."""
        thresholds = refusing(A)
        candidates = [fake_fit(90.0, D, effect) for effect in (A, B, C)]
        monkeypatch.setattr(rescue, "extended", lambda *_: candidates)
        adequate = {A, C}
        monkeypatch.setattr(
            rescue, "adequacy", lambda _, fit: SimpleNamespace(is_adequate=fit.hypothesis.effects[-1] in adequate)
        )
        begin = Selection(fake_fit(200.0), fake_fit(100.0, D), (Entry(D, 100.0, accepted=True, reason=""),))
        found = rescued(evidence, begin, ())
        assert found is not None
        assert (found.nominal, found.fit, found.refused) == (begin.nominal, candidates[2], ())
        assert [(entry.effect, entry.drop, entry.accepted) for entry in found.entries[1:]] == [(C, 10.0, True)]
        assert thresholds == [(A, 9.0), (B, 9.0), (C, 9.0)]
        adequate.remove(C)
        monkeypatch.setattr(rescue, "_with_another", lambda *_: None)
        assert rescued(evidence, begin, ()) is None

    def test_no_weak_third_effect_rescues_a_model(self, evidence, monkeypatch, refusing):
        refusing()
        monkeypatch.setattr(rescue, "extended", lambda *_: [fake_fit(90.0, C, D, A)])
        monkeypatch.setattr(rescue, "adequacy", lambda *_: SimpleNamespace(is_adequate=True))
        monkeypatch.setattr(rescue, "_with_another", lambda *_: None)
        assert rescued(evidence, Selection(fake_fit(200.0), fake_fit(100.0, C, D), ()), ()) is None

    @pytest.mark.parametrize(
        ("cost", "adequate", "chosen"),
        [
            (104.0, {B, C}, (B,)),
            (104.0, {C}, None),
            (105.0, {B, C}, None),
            (99.0, {C}, (B, C)),
            (99.0, set(), None),
        ],
        ids=["as good", "as bad", "worse", "better, beside a further effect", "better, and with structure"],
    )
    def test_an_inadequate_model_is_rescued_by_another_effect_that_costs_at_most_a_little_more(
        self, evidence, monkeypatch, refusing, cost, adequate, chosen
    ):
        """Up to 4.6, within which the data do not tell effects apart. A better one may need a further effect."""
        refusing()
        base, begin = fake_fit(200.0), Selection(fake_fit(200.0), fake_fit(100.0, A), ())
        monkeypatch.setattr(rescue, "extended", lambda *_: [])
        monkeypatch.setattr(rescue, "without", lambda *_: base)
        monkeypatch.setattr(rescue, "_beside", lambda *_: [fake_fit(cost, B)])
        monkeypatch.setattr(rescue, "grown", lambda _, __, fit, ___: (fake_fit(80.0, *fit.hypothesis.effects, C), []))
        monkeypatch.setattr(
            rescue, "adequacy", lambda _, fit: SimpleNamespace(is_adequate=fit.hypothesis.effects[-1] in adequate)
        )
        found = rescued(evidence, begin, ())
        assert (None if found is None else found.fit.hypothesis.effects) == chosen

    def test_where_no_effect_was_selected_each_one_is_tried_by_itself(self, evidence, monkeypatch, refusing):
        refusing(B)
        begin = Selection(fake_fit(100.0), fake_fit(100.0), ())
        monkeypatch.setattr(rescue, "extended", lambda *_: [])
        monkeypatch.setattr(rescue, "_beside", lambda *_: [fake_fit(60.0, B), fake_fit(70.0, C)])
        monkeypatch.setattr(rescue, "grown", lambda _, __, fit, ___: (fit, []))
        monkeypatch.setattr(rescue, "adequacy", lambda *_: SimpleNamespace(is_adequate=True))
        found = rescued(evidence, begin, ())
        assert found is not None
        assert found.fit.hypothesis.effects == (C,)

    @pytest.mark.parametrize(("before", "threshold"), [((), 15.0), ((B,), 15.0), ((B, C), 27.0)])
    def test_a_third_effect_needs_12_more(self, evidence, monkeypatch, refusing, before, threshold):
        thresholds = refusing(A)
        monkeypatch.setattr(stepwise, "extended", lambda *_: [fake_fit(80.0, *before, A)])
        assert stepwise._entered(evidence, fake_fit(100.0, *before), ())[0] is None
        assert thresholds == [(A, threshold)]

    def test_effects_of_other_names_enter_if_they_can_still_lower_the_cost_by_9(self, evidence, monkeypatch):
        scanned, goals = [], []
        monkeypatch.setattr(stepwise, "scan", lambda _, __, effects: scanned.extend(effects) or [])
        monkeypatch.setattr(stepwise, "fitted", lambda _, __, ___, goal: goals.append(goal) or [])
        left = fake_effect("B")
        assert stepwise.extended(evidence, fake_fit(100.0, A, B), (A, left, C, D)) == []
        assert (scanned, goals) == ([C, D], [91.0])

    @pytest.mark.parametrize(("last", "rivals"), [(A, [C, D]), (NOISE, [A, C, D])])
    def test_noise_takes_the_place_of_noise_alone(self, evidence, monkeypatch, last, rivals):
        """A slow rival is fitted up to a cost of 40 more."""
        scanned, goals = [], []
        monkeypatch.setattr(stepwise, "is_of_noise", lambda _, effect: effect is NOISE)
        monkeypatch.setattr(stepwise, "scan", lambda _, __, effects: scanned.extend(effects) or [])
        monkeypatch.setattr(stepwise, "fitted", lambda _, __, ___, goal: goals.append(goal) or [])
        wider = fake_effect("WIDER", slot=Slot.RANGE_NOISE)
        stepwise.replaced(evidence, fake_fit(100.0, B, last), last, fake_fit(120.0, B), (A, B, C, D, NOISE, wider))
        assert scanned == ([*rivals, wider] if last is NOISE else rivals)
        assert goals == [140.0]

    @pytest.mark.parametrize(
        ("rivals", "result"),
        [
            ([(99.0, D)], D),
            ([(100.0, D)], A),
            ([(100.5, D)], A),
            # Two parameters count 6 more than one.
            ([(94.5, WIDE)], A),
            ([(93.5, WIDE)], WIDE),
            # Costs that are equal to a tenth are a tie, which the order of the library has decided.
            ([(90.04, D), (90.0, fake_effect("E"))], D),
            ([(100.04, D), (99.98, fake_effect("E"))], A),
            # One that is refused does not stand in the way of the next.
            ([(98.0, C), (99.0, D)], D),
        ],
    )
    def test_an_earlier_effect_gives_way_to_an_accepted_rival_that_costs_less(
        self, evidence, monkeypatch, refusing, rivals, result
    ):
        """Of three effects the last one, which has just been compared with all others, is not compared again."""
        refusing(C)
        compared = []

        def replaced(_, __, effect, *___):
            compared.append(effect)
            return [fake_fit(cost, B, NOISE, rival) for cost, rival in rivals] if effect is A else []

        monkeypatch.setattr(stepwise, "replaced", replaced)
        without = lambda _, fit, effect: fake_fit(0.0, *(e for e in fit.hypothesis.effects if e is not effect))  # noqa: E731
        monkeypatch.setattr(stepwise, "without", without)
        swapped = stepwise._swapped(evidence, fake_fit(100.0, A, B, NOISE), ())
        assert compared == [A, B]
        assert swapped.hypothesis.effects == ((A, B, NOISE) if result is A else (B, NOISE, result))

    def test_pairs_begin_with_effects_that_differ_and_are_fitted_together_if_they_explain_more_than_one(
        self, evidence, monkeypatch
    ):
        """Singles whose costs are equal to a tenth are one. The best single one explains 20, and a pair 4 more."""
        singles = [fake_fit(80.0, A), fake_fit(80.04, B), fake_fit(80.2, C), fake_fit(81.0, D)]
        pairs = [Fake(drop=drop, hypothesis=FakeHypothesis(*two), start=drop) for drop, *two in (
            (24.5, A, D), (23.5, B, D), (30.0, B, C),
        )]  # fmt: skip
        known, extended, together, goals = fake_fit(50.0, C, B), [], [], []
        monkeypatch.setattr(stepwise, "scanned", lambda *_: [Fake(drop=20.0), Fake(drop=4.0)])
        monkeypatch.setattr(stepwise, "fitted", lambda _, __, ___, goal: goals.append(goal) or singles)
        monkeypatch.setattr(stepwise, "_extended_all", lambda _, several, __: extended.extend(several) or [known])
        monkeypatch.setattr(stepwise, "scan_pairs", lambda *_: pairs)
        monkeypatch.setattr(stepwise, "fits", lambda _, starts, __: together.extend(starts) or [])
        assert stepwise._pairs(evidence, fake_fit(100.0), (A, B, C, D)) == [known]
        assert {single.cost for single in extended} == {80.0, 80.2, 81.0}
        assert goals == [96.0]  # a single effect that explains less than 4 is not fitted to the end
        assert [start for _, start in together] == [24.5]
        # Where no single one explains more than 4, a pair does.
        pairs[:] = [Fake(drop=drop, hypothesis=FakeHypothesis(A, D), start=drop) for drop in (4.5, 3.5)]
        together.clear()
        monkeypatch.setattr(stepwise, "scanned", lambda *_: [Fake(drop=4.0)])
        stepwise._pairs(evidence, fake_fit(100.0), (A, B, C, D))
        assert [start for _, start in together] == [4.5]

    def test_in_the_place_of_two_effects_the_three_most_promising_pairs_are_fitted(self, monkeypatch):
        one_stage: Any = Fake(stages=("motor",))
        pairs, started = [Fake(hypothesis=FakeHypothesis(C, D), start=k) for k in range(5)], []
        monkeypatch.setattr(stepwise, "scan_pairs", lambda *_: pairs)
        monkeypatch.setattr(stepwise, "fits", lambda _, starts, __: started.extend(starts) or [])
        assert stepwise._other_pairs(one_stage, fake_fit(100.0), fake_fit(80.0, A, B), (A, B, C, D)) == []
        assert [start for _, start in started] == [0, 1, 2]

    @pytest.mark.parametrize(("wide", "best"), [(30.0, (A, WIDE)), (35.0, (C, D))])
    def test_of_several_better_pairs_the_one_that_costs_least_is_taken(
        self, evidence, monkeypatch, refusing, wide, best
    ):
        """In whatever order they come, with 6 for each parameter."""
        refusing()
        monkeypatch.setattr(stepwise, "_cancels", lambda *_: False)
        monkeypatch.setattr(stepwise, "without", lambda *_: None)
        pairs = [fake_fit(50.0, A, B), fake_fit(40.0, C, D), fake_fit(wide, A, WIDE)]
        for order in (pairs, pairs[::-1]):
            found = stepwise._best_pair(evidence, fake_fit(200.0), order, fake_fit(100.0, A))
            assert found.hypothesis.effects == best

    def test_an_effect_that_may_no_longer_enter_does_not_change_the_order_of_equal_fits(self):
        fits = [fake_fit(20.0, C, B), fake_fit(20.0, C, A)]
        assert stepwise.ranked(fits, (A, B)) == [fits[1], fits[0]]

    def test_of_equal_fits_the_one_by_an_effect_on_everything_comes_before_one_on_a_single_sensor(self):
        left = fake_effect("LEFT", choices=(("sensor", "left"),))
        fits = [fake_fit(20.0, left), fake_fit(20.0, B), fake_fit(20.0, A)]
        assert stepwise.ranked(fits, (left, A, B)) == [fits[2], fits[1], fits[0]]

    def test_effects_whose_lack_costs_too_little_go_one_by_one_the_most_needless_first(self, evidence, monkeypatch):
        """By the cost beyond 15, and 18 for two parameters; a single effect stays."""
        costs = {(A, B, WIDE): 100.0, (B, WIDE): 110.0, (A, WIDE): 130.0, (A, B): 112.0, (A,): 127.0, (B,): 126.5}

        def without(_, fit, effect):
            left = tuple(e for e in fit.hypothesis.effects if e is not effect)
            return fake_fit(costs[left], *left)

        monkeypatch.setattr(stepwise, "without", without)
        # WIDE lacks 6 of what it needs and A 5; then B lacks nothing and A lacks half.
        pruned = stepwise._pruned(evidence, fake_fit(100.0, A, B, WIDE))
        assert pruned.hypothesis.effects == (B,)
        costs[B,] = 127.0
        assert stepwise._pruned(evidence, fake_fit(100.0, A, B, WIDE)).hypothesis.effects == (A, B)

    def test_what_was_scanned_or_fitted_from_an_evidence_is_known(self, evidence, monkeypatch):
        """A fit without one effect may cost 40 more before it is stopped."""
        work = []
        monkeypatch.setattr(stepwise, "scan", lambda *_: work.append("scan") or [])
        for module in (stepwise, removal):
            monkeypatch.setattr(module, "fits", lambda _, __, goal: work.append(goal) or [fake_fit(1.0, A)])
        monkeypatch.setattr(removal, "moved", lambda *_: None)
        fit: Any = Fake(cost=100.0, hypothesis=Fake(without=lambda _: FakeHypothesis(B)), x=None)
        for _ in range(2):
            stepwise.scanned(evidence, fit, (A,))
            stepwise.fitted(evidence, fit, (), 91.0)
            stepwise.without(evidence, fit, A)
        assert work == ["scan", 91.0, 140.0]
