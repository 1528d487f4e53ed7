import numpy as np
import pytest

from diagnosis.inference.likelihood import CORNER, SPREAD, loss, robust_weight


def test_near_zero_the_loss_is_that_of_least_squares():
    assert loss(np.array([0.05])) == pytest.approx(0.05**2, rel=1e-3)


def test_far_out_ten_times_as_far_costs_the_same_again():
    far = loss(np.array([1e3, 1e4, 1e5]))
    assert far[2] - far[1] == pytest.approx(far[1] - far[0], rel=1e-4)
    assert far[1] - far[0] == pytest.approx(2.0 * CORNER**2 * np.log(10.0), rel=1e-4)


def test_the_weight_is_half_the_slope_of_the_loss_over_z():
    z = np.array([0.3, 1.0, 4.0, 20.0])
    slope = (loss(z + 1e-6) - loss(z - 1e-6)) / 2e-6
    np.testing.assert_allclose(robust_weight(z), 0.5 * slope / z, rtol=1e-6)


def test_the_spread_is_the_mean_over_normal_deviates():
    z = np.random.default_rng(5).standard_normal(400_000)
    assert np.mean(z**2 * robust_weight(z)) == pytest.approx(SPREAD, abs=0.005)
