"""Batches of limited size."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symolo.core.batches import batches


@given(st.lists(st.integers(0, 20)), st.integers(1, 30))
def test_batches_hold_all_items_in_order_and_no_batch_can_take_the_next_item(sizes, max_size):
    parts = list(batches(sizes, int, max_size))
    assert [size for part in parts for size in part] == sizes
    assert all(sum(part) <= max_size or len(part) == 1 for part in parts)
    assert all(sum(part) + following[0] > max_size for part, following in pairwise(parts))


@pytest.mark.parametrize("sizes", [[], [9]])
def test_nothing_is_no_batch_and_a_large_item_is_one(sizes):
    assert list(batches(sizes, int, 5)) == [(size,) for size in sizes]
