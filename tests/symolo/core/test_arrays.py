"""What is added to numpy."""

import numpy as np
import pytest

from symolo.core.arrays import stacked_rows


@pytest.mark.parametrize("shape", [(), (3, 1), (2, 3, 1)])
def test_rows_are_stacked_as_numpy_does_it(shape):
    rows = [0.5, np.arange(3.0)[:, None], np.arange(6.0).reshape(2, 3, 1)]
    *expected, _ = np.broadcast_arrays(*rows, np.zeros(shape))
    np.testing.assert_array_equal(stacked_rows(rows, shape), np.stack(expected))


def test_rows_that_are_numbers_take_the_shape_that_is_asked_for():
    np.testing.assert_array_equal(stacked_rows([1.0, 2.0], (2, 1)), [[[1.0], [1.0]], [[2.0], [2.0]]])
