"""Whether the voltage of a bench rises or falls, on which a friction with hysteresis depends."""

import numpy as np

from diagnosis.predictors.motor.steady import _size_step


def test_the_step_is_that_of_the_size_whatever_the_sign():
    np.testing.assert_allclose(_size_step(np.array([1.0, -3.0, 2.5, 0.0])), [np.nan, 2.0, -0.5, -2.5])


def test_steps_that_differ_in_rounding_only_are_equal():
    """0.25 V and its multiples are exact in binary numbers, 0.17 V is not."""
    for step_V in (0.25, 0.17):
        steps = _size_step(step_V * np.arange(1.0, 30.0))
        assert len(np.unique(steps[1:])) == 1
