"""Random changes of readings stay within what a camera and a sensor give, and leave the originals alone."""

import numpy as np
import pytest

from pipeline.baselines.learned.augmentation import LOST, augmented
from pipeline.baselines.learned.readings import HEIGHT, RANGE_NUMBERS, WIDTH, NetworkReadings


@pytest.fixture
def readings():
    rng = np.random.Generator(np.random.PCG64(1))
    target = (rng.random((40, RANGE_NUMBERS // 2)) < 0.5).astype(float)
    return NetworkReadings(rng.random((40, HEIGHT, WIDTH)), np.column_stack((target, target * rng.random((40, 3)))))


def rng():
    return np.random.Generator(np.random.PCG64(2))


def test_the_changes_are_those_of_the_generator(readings):
    rows = np.arange(40)
    before = readings.grey.copy()
    one, two = augmented(readings, rows, rng()), augmented(readings, rows, rng())
    assert np.array_equal(one.grey, two.grey)
    assert np.array_equal(one.ranges, two.ranges)
    assert np.array_equal(readings.grey, before)
    assert not np.array_equal(one.grey, before)
    assert one.grey.min() >= 0.0
    assert one.grey.max() <= 1.0


def test_a_range_without_target_stays_without_and_some_targets_are_lost(readings):
    rows = np.tile(np.arange(40), 8)
    changed = augmented(readings, rows, rng()).ranges
    had, has = readings.ranges[rows, :3] == 1.0, changed[:, :3] == 1.0
    assert not (has & ~had).any()
    assert np.all(changed[:, 3:][~has] == 0.0)
    assert (had & ~has).sum() / had.sum() == pytest.approx(LOST, abs=0.05)
