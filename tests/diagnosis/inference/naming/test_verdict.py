"""The rules from evidence to verdict, for any evidence: they must never contradict each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from diagnosis.inference.naming.verdict import (
    CHEAPER,
    DOUBT,
    MIN_WEIGHT,
    NEARLY,
    NOISY,
    CaseVerdict,
    NameEvidence,
    WithheldName,
    conclusion,
    withheld,
)
from diagnosis.inference.selection.refusal import CLEAR
from diagnosis.inference.selection.removal import cancel
from diagnosis.inference.unexplained.unlisted import BETTER

numbers = st.floats(-200.0, 200.0)
evidences = st.builds(
    NameEvidence,
    name=st.just("supply_sag"),
    rise=st.floats(0.0, 500.0),
    needed=st.just(15.0),
    rise_of_prior=numbers,
    heldout_rise=st.none() | numbers,
    is_at_bound=st.booleans(),
    contradicted_by=st.sampled_from(["", "the trials line/* (it describes arc/*)"]),
    cancelled_by=st.sampled_from(["", "range_offset"]),
    closest_rival=st.none() | st.tuples(st.just("speed_scale"), numbers),
    ahead=numbers | st.just(-np.inf),
    confidence=st.floats(0.0, 1.0),
    gain_at_most=st.none() | st.floats(-1.0, 1.0),
    gain_at_least=st.none() | st.floats(-1.0, 1.0),
    is_far_below_a_row=st.booleans(),
)
names = st.lists(st.sampled_from(["supply_sag", "range_offset"]), max_size=2, unique=True)
withheld_names = st.lists(st.just(WithheldName("speed_scale", "reason")), max_size=1)


@given(evidences)
def test_a_name_that_stands_has_nothing_against_it(evidence):
    if withheld(evidence):
        return
    assert not evidence.is_at_bound
    assert not evidence.cancelled_by
    assert not evidence.contradicted_by
    assert evidence.closest_rival is None or evidence.closest_rival[1] >= -CHEAPER
    assert evidence.ahead < BETTER
    assert evidence.confidence >= MIN_WEIGHT
    # Held-out rows count, but not against an effect whose work parameters far out of their tolerances do there.
    is_imitated = evidence.rise_of_prior > 0.5 * evidence.rise
    heldout_rise = 0.0 if evidence.heldout_rise is None else evidence.heldout_rise
    heldout_rise = max(heldout_rise, 0.0) if is_imitated else heldout_rise
    # An error that is a little larger says nothing where the rows are more likely with the effect.
    is_closer = evidence.gain_at_most is None or evidence.gain_at_most >= 0.0
    assert is_closer or is_imitated or heldout_rise > 0.0
    assert heldout_rise >= -CLEAR
    assert evidence.rise + heldout_rise >= evidence.needed


@given(evidences.filter(lambda evidence: bool(withheld(evidence))))
def test_a_withheld_name_has_a_reason_that_is_true(evidence):
    reason = withheld(evidence)
    assert ("end of the possible range" in reason) <= evidence.is_at_bound
    assert ("cancel" in reason) <= bool(evidence.cancelled_by)
    assert ("description" in reason) <= bool(evidence.contradicted_by)
    if "simple form" in reason:
        assert evidence.ahead > 0.0
    elif "explains the data better" in reason:
        assert evidence.closest_rival is not None
        assert evidence.closest_rival[1] < 0.0
    if "two rows" in reason:
        assert evidence.is_far_below_a_row
        assert evidence.gain_at_least is not None
        assert evidence.gain_at_least <= 0.0
    elif "interval" in reason:
        assert evidence.gain_at_most is not None
        assert evidence.gain_at_most < 0.0
    elif "held-out" in reason:
        assert evidence.heldout_rise is not None
        assert evidence.heldout_rise < 0.0


@pytest.mark.parametrize(
    ("rise", "heldout_rise", "stands"),
    [
        (60.0, 20.0, True),
        (60.0, -0.5, True),
        (60.0, -CLEAR - 1.0, False),
        (20.0, -3.0, False),
        (15.5, 10.0, True),
        (15.5, 0.5, False),
        (60.0, None, True),
    ],
    ids=[
        "held-out rows confirm it",
        "held-out rows hardly show it",
        "held-out rows contradict it",
        "weak, and weakened by held-out rows",
        "weak, and confirmed by held-out rows",
        "weak, and not confirmed",
        "no held-out rows",
    ],
)
def test_fitted_and_held_out_rows_are_weighed_together(rise, heldout_rise, stands):
    """Log-likelihood ratios of independent rows add up."""
    evidence = NameEvidence("supply_sag", rise, 15.0, 0.0, heldout_rise, False, "", "", None, -9.0, 0.97)  # noqa: FBT003
    assert (not withheld(evidence)) is stands


@pytest.mark.parametrize(("heldout_rise", "stands"), [(20.0, True), (-20.0, False)])
def test_held_out_rows_speak_for_an_effect_that_nominal_parameters_imitate_in_the_others(heldout_rise, stands):
    """The whole rise of 15.5 comes from parameters, which predict the held-out rows far worse, or better."""
    evidence = NameEvidence("supply_sag", 15.5, 15.0, 15.5, heldout_rise, False, "", "", None, -9.0, 0.97)  # noqa: FBT003
    assert evidence.is_imitated
    assert (not withheld(evidence)) is stands


doubts = st.fixed_dictionaries(
    {"chance": st.floats(0.0, 1.0), "nearly": st.floats(0.0, 15.0), "scatter": st.floats(0.5, 2.0)}
)


@given(names, withheld_names, st.booleans(), doubts)
def test_the_conclusion_never_contradicts_the_evidence(standing, not_standing, is_adequate, doubt):
    found = conclusion(standing, not_standing, is_adequate=is_adequate, **doubt)
    assert (found in {CaseVerdict.NAMED, CaseVerdict.NAMED_IN_PART}) == bool(standing)
    assert (found in {CaseVerdict.NAMED_IN_PART, CaseVerdict.UNEXPLAINED}) == (not is_adequate)
    if found is CaseVerdict.EXPLAINED:
        assert doubt["chance"] >= DOUBT
        assert doubt["nearly"] < NEARLY
        assert doubt["scatter"] < NOISY
        assert not not_standing


@given(doubts)
def test_more_doubt_never_makes_a_model_an_explanation(doubt):
    def explained(**more):
        return conclusion([], [], is_adequate=True, **{**doubt, **more}) is CaseVerdict.EXPLAINED

    assert explained(chance=0.5 * doubt["chance"]) <= explained()
    assert explained(nearly=doubt["nearly"] + 1.0) <= explained()
    assert explained(scatter=doubt["scatter"] * 1.2) <= explained()


@pytest.mark.parametrize(("factor", "cancels"), [(-1.0, True), (-0.8, True), (-0.4, False), (1.0, False)])
def test_changes_cancel_that_are_nearly_opposite_and_equally_large(factor, cancels):
    change = np.linspace(-1.0, 2.0, 50)
    assert cancel(change, factor * change) is cancels


def test_changes_of_different_shape_do_not_cancel():
    x = np.linspace(0.0, 1.0, 50)
    assert not cancel(np.ones(50), -2.0 * x)


@pytest.mark.parametrize(
    ("is_far_below_a_row", "gain_at_least", "stands"),
    [(True, 0.01, True), (True, -0.01, False), (True, None, True), (False, -0.01, True)],
)
def test_a_lag_far_below_a_row_stands_only_if_held_out_rows_gain_by_it(is_far_below_a_row, gain_at_least, stands):
    evidence = NameEvidence(
        "actuator_lag",
        *(60.0, 15.0, 0.0, 5.0, False, "", "", None, -9.0, 0.97),
        gain_at_most=0.1,
        gain_at_least=gain_at_least,
        is_far_below_a_row=is_far_below_a_row,
    )
    assert (not withheld(evidence)) is stands
