"""States on images: each has a mark of its own, and each row belongs to one stretch."""

from itertools import combinations, pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from symolo.dataset.tables.rows import NO_STATE, STATES
from symolo.pages.states import STATE_STYLES, stretches

# Okabe and Ito, Color Universal Design (2008), without the yellow that a white page swallows; and a grey.
SAFE = {"#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7", "#777777"}


@given(st.lists(st.sampled_from(STATES), min_size=1, max_size=60))
def test_stretches_join_up_and_each_row_is_of_its_state(states):
    stretch_list = stretches(np.array(states))
    assert [part.state for part in stretch_list for _ in range(part.first, part.end)] == states
    assert all(one.state != other.state for one, other in pairwise(stretch_list))


def test_every_state_has_a_safe_colour_and_a_mark_unlike_all_others():
    assert set(STATE_STYLES) == {*STATES, NO_STATE}
    assert {mark.colour for mark in STATE_STYLES.values()} <= SAFE
    for one, other in combinations(STATE_STYLES.values(), 2):
        assert (one.colour, one.dash) != (other.colour, other.dash)
        assert one.name != other.name
