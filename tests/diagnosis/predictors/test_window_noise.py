"""The noise of overlapping windows from what a model leaves, on noise that was drawn."""

import numpy as np
import pytest

from diagnosis.predictors.pose.window_noise import window_noise

SD = 0.3
SHARE_NO_POSE = 3


@pytest.fixture
def left():
    """Changes over windows of two steps, each begun one step after the one before: of white noise in every pose."""
    poses = SD / np.sqrt(2.0) * np.random.default_rng(4).standard_normal(4002)
    return poses[2:] - poses[:-2]


def test_noise_of_windows_that_share_poses_is_found(left):
    sd = window_noise(left, np.zeros(4000, dtype=int), np.ones(4000, dtype=bool), SHARE_NO_POSE)
    assert sd == pytest.approx(SD, rel=0.05)


def test_what_bends_slowly_is_no_noise(left):
    slow = left + 3.0 * np.sin(np.arange(4000) / 500.0)
    sd = window_noise(slow, np.zeros(4000, dtype=int), np.ones(4000, dtype=bool), SHARE_NO_POSE)
    assert sd == pytest.approx(SD, rel=0.05)


def test_steps_from_trial_to_trial_and_rows_held_out_do_not_count(left):
    trial = np.arange(4000) // 8
    stepped = left + 100.0 * trial
    rows = trial % 2 == 0
    stepped[~rows] += np.arange(2000) % 2 * 50.0
    assert window_noise(stepped, trial, rows, SHARE_NO_POSE) == pytest.approx(SD, rel=0.08)


def test_too_few_windows_or_none_that_scatter_show_nothing():
    flat = np.zeros(40)
    assert window_noise(flat, np.zeros(40, dtype=int), np.ones(40, dtype=bool), SHARE_NO_POSE) is None
    assert window_noise(flat[:8], np.zeros(8, dtype=int), np.ones(8, dtype=bool), SHARE_NO_POSE) is None
