"""The calibrations that the diagnosis is held against find wheels that were planted."""

import importlib
from math import pi
from pathlib import Path

import numpy as np
import pytest

COUNTS = 43.7 * 64


@pytest.fixture(scope="module")
def trade():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks" / "diagnosis" / "recordings"))
        yield importlib.import_module("wheel_calibrations")


@pytest.fixture(scope="module")
def nominal(trade):
    return trade.Wheels(0.084, 0.084, 0.2)


@pytest.fixture(scope="module")
def squares(trade):
    """Driven by counts as a controller with the nominal wheels would drive them: sides, then turns by 90 degrees."""
    found = []
    for sense in (-1, 1, -1, 1):
        straight = np.full(400, 0.75 / 400 / (pi * 0.084) * COUNTS)
        turn = np.full(100, sense * (pi / 2) * 0.2 / 2 / 100 / (pi * 0.084) * COUNTS)
        run = np.zeros((2001, 6))
        run[1:, 4], run[1:, 5] = np.tile(np.r_[straight, turn], 4), np.tile(np.r_[straight, -turn], 4)
        run[:, 1:4] = trade.odometry(run, trade.Wheels(0.0838, 0.0839, 0.2015), COUNTS)
        found.append(run)
    return found


def test_whole_paths_give_back_the_wheels(trade, nominal, squares):
    calibrated = trade.by_whole_paths(squares, nominal, COUNTS)
    np.testing.assert_allclose(
        (calibrated.left_diameter_m, calibrated.right_diameter_m, calibrated.track_m),
        (0.0838, 0.0839, 0.2015),
        rtol=1e-6,
    )


def test_umbmark_finds_track_and_ratio_of_the_wheels_but_not_their_size(trade, nominal, squares):
    """It holds for small errors; here they are some parts in a thousand."""
    calibrated = trade.umbmark(squares, 0.75, nominal, COUNTS)
    assert calibrated.right_diameter_m / calibrated.left_diameter_m == pytest.approx(839 / 838, abs=2e-4)
    assert calibrated.track_m / (calibrated.left_diameter_m + calibrated.right_diameter_m) == pytest.approx(
        0.2015 / (0.0838 + 0.0839), rel=1.5e-3
    )
    assert calibrated.left_diameter_m + calibrated.right_diameter_m == pytest.approx(0.168)


def test_a_camera_body_that_stands_askew_is_distinguished_from_the_wheels(trade, nominal, squares):
    askew = []
    for run in squares:
        seen = run.copy()
        seen[:, 1:4] = trade.turned(run[:, 1:4], -0.006)
        askew.append(seen)
    found, off = trade.with_turned_camera(askew, nominal, COUNTS)
    assert off == pytest.approx(-0.006, rel=1e-3)
    assert found.track_m == pytest.approx(0.2015, rel=1e-5)


def test_straight_ahead_is_one_turn_of_the_wheel_for_its_counts(trade, nominal):
    run = np.zeros((2, 6))
    run[1, 4:] = COUNTS
    np.testing.assert_allclose(trade.odometry(run, nominal, COUNTS)[-1], [pi * 0.084, 0.0, 0.0])
