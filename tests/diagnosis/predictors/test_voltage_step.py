"""Whether the voltage of a bench rises or falls, on which a friction with hysteresis depends."""

import numpy as np

from diagnosis.predictors.motor_steady import _size_step


def test_the_step_is_that_of_the_size_whatever_the_sign():
    np.testing.assert_allclose(_size_step(np.array([1.0, -3.0, 2.5, 0.0])), [np.nan, 2.0, -0.5, -2.5])
