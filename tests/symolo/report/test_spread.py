"""Few of many: in order, no more than asked for, ends included."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from symolo.report.statistics.spread import spread


@given(st.integers(0, 200), st.integers(2, 20))
def test_the_first_and_the_last_are_among_them_and_gaps_are_even(count, most):
    chosen = spread(range(count), most)
    assert len(chosen) == min(count, most)
    gaps = [b - a for a, b in itertools.pairwise(chosen)]
    if gaps:
        assert (chosen[0], chosen[-1]) == (0, count - 1)
        assert min(gaps) >= 1
        assert max(gaps) - min(gaps) <= 2


def test_of_one_it_is_the_middle_and_of_none_there_is_none():
    assert spread("abcde", 1) == ["c"]
    assert spread("abc", 0) == []
    assert spread("", 5) == []
