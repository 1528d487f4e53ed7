"""Depth from a pair of images whose shift is known."""

import numpy as np
import pytest

from pipeline.baselines.further_sensors.scans import OdometryPath
from pipeline.baselines.further_sensors.stereo_log import StereoLog
from pipeline.baselines.further_sensors.stereo_matching import MIN_HEIGHT_M, SD_PX, scans_of
from pipeline.baselines.robot_knowledge import Start

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M, SHIFT_PX = 160, 80, 120.0, 0.06, 9
X_RC = np.array([[0.0, 0.0, 1.0, 0.05], [-1.0, 0.0, 0.0, 0.03], [0.0, -1.0, 0.0, 0.1], [0.0, 0.0, 0.0, 1.0]])
"""A camera that looks ahead: x of C is to the right, y down."""


@pytest.fixture(scope="module")
def before_a_poster():
    """Two cameras before a plane of noise; the right one sees it further to the left."""
    noise = np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH + SHIFT_PX, 3), dtype=np.uint8)
    pair = noise[:, :WIDTH], noise[:, SHIFT_PX:]
    K = np.array([[FOCAL_PX, 0.0, 79.5], [0.0, FOCAL_PX, 39.5], [0.0, 0.0, 1.0]])
    return StereoLog(np.array([0.0]), lambda _: pair, K, X_RC, BASELINE_M)


def test_points_lie_on_the_plane_that_the_shift_shows(before_a_poster):
    points, depth_m = before_a_poster.points(0)
    expected_m = FOCAL_PX * BASELINE_M / SHIFT_PX
    assert len(points) > 400
    assert np.median(np.abs(depth_m - expected_m)) < 0.002
    assert np.mean(np.abs(points[:, 0] - 0.05 - expected_m) < 0.02) > 0.95
    # The left and upper end of the images, a little less than half of them away from the axis.
    assert points[:, 1].min() == pytest.approx(0.03 - expected_m * 78 / FOCAL_PX, abs=0.03)
    assert points[:, 2].max() == pytest.approx(0.1 + expected_m * 37.5 / FOCAL_PX, abs=0.03)


def test_a_scan_has_the_noise_of_the_disparity_and_no_floor(before_a_poster, before_a_wall):
    standing = before_a_wall(np.zeros((2, 2)), np.full(2, np.nan), Start(np.zeros(3), np.ones(3)))
    (scan,) = scans_of(before_a_poster, OdometryPath(standing)).scans
    assert scan.points_R[:, 2].min() > MIN_HEIGHT_M
    range_m = np.linalg.norm(scan.points_R - X_RC[:3, 3], axis=1)
    further_m = range_m * SHIFT_PX / (SHIFT_PX - SD_PX)  # the same ray, with less disparity
    typical = np.abs(scan.points_R[:, 0] - 0.05 - 0.8) < 0.02
    assert scan.sd_m[typical] == pytest.approx((further_m - range_m)[typical], rel=0.15)
    assert (scan.by_lasting < 0).all()
