"""Scan matching in a rectangular room, whose distances are known in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from pipeline.baselines.further_sensors.lidar_log import LidarLog
from pipeline.baselines.further_sensors.lidar_matching import scans_of
from pipeline.baselines.further_sensors.scan_filter import matched
from pipeline.baselines.further_sensors.scans import MatchedScan, OdometryPath, ScanLog
from pipeline.baselines.robot_knowledge import MAP_SD_M, Start
from sensors.ranging.lidar import LidarSettings
from symolo.arena.geometry import Box
from symolo.evaluation.errors import nees

HALF_M = np.array([1.5, 1.0])
"""Half the length and width of the room, whose middle is the origin."""
RAYS = 120
SD_M, LASTING_SD_M = 0.004, 0.003
TRUE = np.array([0.3, -0.2, 0.4])
STANDING = np.zeros((1, 2))
ROOM = tuple(
    Box(name, "wall", center, size, 0.0, "white_board")
    for name, center, size in (
        ("east", (HALF_M[0] + 0.05, 0.0, 0.2), (0.1, 4.0, 0.4)),
        ("west", (-HALF_M[0] - 0.05, 0.0, 0.2), (0.1, 4.0, 0.4)),
        ("north", (0.0, HALF_M[1] + 0.05, 0.2), (4.0, 0.1, 0.4)),
        ("south", (0.0, -HALF_M[1] - 0.05, 0.2), (4.0, 0.1, 0.4)),
    )
)


def distances_m(places, angles_rad, half_m=((-HALF_M[0], -HALF_M[1]), (HALF_M[0], HALF_M[1]))):
    """Return the distances (K,) from places (K, 2) in the room to its walls at x and y of `half_m`."""
    along = np.column_stack((np.cos(angles_rad), np.sin(angles_rad)))
    low, high = (np.asarray(walls) for walls in half_m)
    with np.errstate(divide="ignore"):
        return (np.where(along > 0, high, low) / along - places / along).min(axis=1)


def scan_of(range_m):
    angles = np.arange(RAYS) * 2 * np.pi / RAYS
    origins = np.tile([0.0, 0.0, 0.1], (RAYS, 1))
    points = origins + range_m[:, None] * np.column_stack((np.cos(angles), np.sin(angles), np.zeros(RAYS)))
    return MatchedScan(0, origins, points, np.full(RAYS, SD_M), np.zeros(RAYS), np.ones(RAYS))


def ranges_from(pose, half_m=((-HALF_M[0], -HALF_M[1]), (HALF_M[0], HALF_M[1]))):
    angles = pose[2] + np.arange(RAYS) * 2 * np.pi / RAYS
    return distances_m(np.tile(pose[:2], (RAYS, 1)), angles, half_m)


@pytest.fixture
def in_the_room(before_a_wall):
    def knowledge(start, rolled_m=STANDING):
        one = before_a_wall(rolled_m, np.full(len(rolled_m), np.nan), start)
        return replace(one, map=replace(one.map, boxes=ROOM))

    return knowledge


def test_an_exact_scan_shows_the_pose_from_a_wrong_start(in_the_room):
    start = Start(TRUE + np.array([0.06, -0.05, 0.08]), np.array([0.05, 0.05, 0.08]))
    log = ScanLog((scan_of(ranges_from(TRUE)),), LASTING_SD_M)
    assert matched(in_the_room(start), log).pose[0] == pytest.approx(TRUE, abs=1e-3)


def test_a_lidar_without_errors_shows_the_pose(in_the_room):
    lidar = LidarSettings(
        rays=RAYS, ray_step_deg=3, sweep_s=0, noise_m=0, noise_share=0, offset_sd_m=0, quantisation_m=0
    )
    range_m = np.round(np.roll(ranges_from(TRUE), RAYS // 2), 4)  # the first ray points backwards
    knowledge = in_the_room(Start(TRUE + np.array([0.02, 0.01, -0.02]), np.full(3, 0.02)))
    log = scans_of(LidarLog(np.array([0.0]), range_m[None], lidar), OdometryPath(knowledge))
    assert matched(knowledge, log).pose[0] == pytest.approx(TRUE, abs=1e-3)


def test_what_is_on_no_map_changes_nothing(in_the_room):
    """Somebody's legs hide a third of the walls."""
    range_m = ranges_from(TRUE)
    range_m[10:50] = 0.3
    start = Start(TRUE + np.array([0.02, 0.01, -0.02]), np.array([0.02, 0.02, 0.02]))
    estimate = matched(in_the_room(start), ScanLog((scan_of(range_m),), LASTING_SD_M))
    assert estimate.pose[0] == pytest.approx(TRUE, abs=1e-3)


def test_a_surface_that_most_of_its_rays_do_not_meet_is_not_used(in_the_room):
    """A cupboard stands before the wall to the north; by chance, some of its shelves are only 3 cm before the wall."""
    range_m = ranges_from(TRUE)
    angles = TRUE[2] + np.arange(RAYS) * 2 * np.pi / RAYS
    (north,) = np.nonzero(np.isclose(TRUE[1] + range_m * np.sin(angles), HALF_M[1]))
    range_m[north] -= np.where(np.arange(len(north)) % 4 == 0, 0.03, 0.5)
    start = Start(TRUE, np.array([0.02, 0.02, 0.02]))
    estimate = matched(in_the_room(start), ScanLog((scan_of(range_m),), LASTING_SD_M))
    assert estimate.pose[0] == pytest.approx(TRUE, abs=1e-3)


def test_without_a_scan_that_agrees_with_the_map_the_wheels_decide(in_the_room):
    start = Start(TRUE, np.array([0.001, 0.001, 0.001]))
    wrong = ScanLog((scan_of(np.full(RAYS, 0.2)),), LASTING_SD_M)
    assert matched(in_the_room(start), wrong).pose[0] == pytest.approx(TRUE, abs=1e-12)


def test_in_a_world_as_it_takes_it_for_its_covariance_is_honest(in_the_room):
    """NEES over rooms whose walls stand wrong by the accuracy of the map, with noise and an offset of all ranges."""
    count, total, start_sd = 60, 0.0, np.array([0.01, 0.01, 0.01])
    for seed in range(count):
        rng = np.random.Generator(np.random.PCG64(seed))
        walls = np.array([-HALF_M, HALF_M]) + MAP_SD_M * rng.standard_normal((2, 2))
        range_m = ranges_from(TRUE, walls) + LASTING_SD_M * rng.standard_normal() + SD_M * rng.standard_normal(RAYS)
        start = Start(TRUE + start_sd * rng.standard_normal(3), start_sd)
        estimate = matched(in_the_room(start), ScanLog((scan_of(range_m),), LASTING_SD_M))
        total += nees(estimate, TRUE[None])[0]
    low, high = chi2.ppf([0.001, 0.999], 3 * count)
    assert low < total < high


def test_rays_that_were_measured_during_a_turn_are_placed_where_the_robot_was(in_the_room):
    """A robot turns at 2 rad/s on the spot; seen from the row after a scan, all of its points lie on the walls."""
    rows, track_m, row_s, rate_rad_s = 9, 0.14, 0.05, 2.0
    rolled_m = 0.5 * track_m * rate_rad_s * row_s * np.array([1.0, -1.0])
    wheels = np.vstack((np.zeros(2), np.tile(rolled_m, (rows - 1, 1))))
    lidar = LidarSettings(rays=RAYS, first_ray_deg=-90, ray_step_deg=3, sweep_s=0.1, x_m=0.1, y_m=-0.05, yaw_deg=20)
    t_s = 0.32  # between two rows
    ray = np.arange(RAYS)
    at_rad = TRUE[2] + rate_rad_s * (t_s - (RAYS - 1 - ray) * 0.1 / RAYS)
    c, s = np.cos(at_rad), np.sin(at_rad)
    places = np.column_stack((TRUE[0] + c * 0.1 + s * 0.05, TRUE[1] + s * 0.1 - c * 0.05))
    range_m = distances_m(places, at_rad + np.radians(20 - 90 + 3 * ray))
    knowledge = in_the_room(Start(TRUE, np.full(3, 1e-3)), wheels)
    log = scans_of(LidarLog(np.array([t_s]), range_m[None], lidar), OdometryPath(knowledge))
    (scan,) = log.scans
    assert knowledge.t_s[scan.row] == pytest.approx(0.35)
    yaw = TRUE[2] + rate_rad_s * 0.35
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    points = TRUE[:2] + scan.points_R[:, :2] @ turn.T
    assert np.abs(np.abs(points) - HALF_M).min(axis=1).max() < 3e-4
    assert scan.points_R[:, 2] == pytest.approx(lidar.z_m)
