"""What pixels see of the floor, without Blender: against the camera model, ray by ray and moment by moment."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.hybrid.floor.sight import MIDDLE, FilterPoint, FloorSight, filter_points
from sensors.camera.shutter import exposed, moment, window
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Shutter, floor_points, intrinsics, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR
from symolo.core.geometry.robot_path import RobotPath

WIDTH_PX, HEIGHT_PX = 48, 36
POSE = (0.3, -0.7, 2.0)
T_S = 0.5
SPEED_M_S, RATE_RAD_S = 0.8, 3.0
SHUTTER = Shutter(exposure_s=0.01, read_out_s=0.02)


@pytest.fixture(scope="module")
def camera(robot):
    """Level enough that its upper rows see no floor."""
    return intrinsics(robot.camera, WIDTH_PX, HEIGHT_PX)


@pytest.fixture(scope="module")
def X_RC(robot):
    level = robot.camera.model_copy(update={"pitch_down_deg": 12.0, "yaw_left_deg": 7.0, "roll_deg": 3.0})
    return pose_X_RC(level, robot.chassis.base_height_m)


@pytest.fixture(scope="module")
def view(arena, X_RC) -> FrameView:
    at = moment(arena, X_RC, POSE, T_S)
    return FrameView(1, T_S, at.robot_pose, at.X_WC)


@pytest.fixture(scope="module")
def path() -> RobotPath:
    """On an arc, through `POSE` at `T_S`."""
    times = np.linspace(0.0, 1.0, 201)
    yaw = POSE[2] + RATE_RAD_S * (times - T_S)
    radius = SPEED_M_S / RATE_RAD_S
    x = POSE[0] + radius * (np.sin(yaw) - np.sin(POSE[2]))
    y = POSE[1] - radius * (np.cos(yaw) - np.cos(POSE[2]))
    twist = np.broadcast_to((SPEED_M_S, RATE_RAD_S), (len(times), 2))
    return RobotPath(times, np.column_stack([x, y, yaw]), np.array(twist))


def _seen(camera, X_WC, right_px=0.0, down_px=0.0, rows=range(HEIGHT_PX)) -> np.ndarray:
    """(rows, W, 2) by the camera model, pixel by pixel."""
    places = np.array([(u + right_px, v + down_px) for v in rows for u in range(WIDTH_PX)], float)
    return floor_points(camera, np.array(X_WC), places)[:, :2].reshape(len(rows), WIDTH_PX, 2)


def _agree(found, expected) -> None:
    """To single precision, and nowhere where the other sees no floor; far points are as uncertain as they are far."""
    assert (np.isnan(found) == np.isnan(expected)).all()
    assert np.isnan(expected).any()
    assert not np.isnan(expected).all()
    near = np.linalg.norm(expected - POSE[:2], axis=-1) < 20
    np.testing.assert_allclose(found[near], expected[near], atol=1e-5)


@pytest.mark.parametrize(("right_px", "down_px"), [(0.0, 0.0), (0.4, -1.1), (-1.2, 0.3)])
def test_a_pixel_sees_the_floor_point_of_the_camera_model(camera, view, right_px, down_px):
    sight = FloorSight(camera, view, 1.0)
    _agree(sight.points(view, FilterPoint(right_px, down_px, 0.5)), _seen(camera, view.X_WC, right_px, down_px))


def test_points_of_some_rows_are_those_of_the_full_image(camera, view):
    sight, rows = FloorSight(camera, view, 1.0), slice(20, 27)
    np.testing.assert_array_equal(sight.points(view, MIDDLE, rows), sight.points(view, MIDDLE)[rows])


def test_another_view_is_seen_from_where_the_robot_is_then(camera, arena, X_RC, view):
    at = moment(arena, X_RC, (-1.0, 0.4, -2.5), 0.0)
    other = replace(view, robot_pose=at.robot_pose, X_WC=at.X_WC)
    found, expected = FloorSight(camera, view, 1.0).points(other, MIDDLE), _seen(camera, at.X_WC)
    near = np.linalg.norm(expected - (-1.0, 0.4), axis=-1) < 20
    np.testing.assert_allclose(found[near], expected[near], atol=1e-5)


def test_depth_is_that_of_the_floor_along_the_axis(camera, view):
    found = FloorSight(camera, view, 1.0).depth_m()
    X_WC = np.array(view.X_WC)
    points = np.concatenate([_seen(camera, X_WC), np.zeros((HEIGHT_PX, WIDTH_PX, 1))], axis=-1)
    expected = (points - X_WC[:3, 3]) @ X_WC[:3, 2]
    assert (np.isnan(found) == np.isnan(expected)).all()
    np.testing.assert_allclose(found, expected, rtol=1e-4)


def test_straight_down_the_depth_is_the_height(camera, view):
    down = ((1.0, 0.0, 0.0, POSE[0]), (0.0, -1.0, 0.0, POSE[1]), (0.0, 0.0, -1.0, 0.7), (0.0, 0.0, 0.0, 1.0))
    assert FloorSight(camera, replace(view, X_WC=down), 1.0).depth_m() == pytest.approx(0.7)


def test_a_pixel_covers_the_floor_between_its_borders(camera, view):
    """As far as a pixel is small beside what it is away."""
    sight = FloorSight(camera, view, 1.0)
    across_m, along_m = sight.pixel_m()
    left, right, up, down = (
        sight.points(view, FilterPoint(*place, 0.5)) for place in ((-0.05, 0.0), (0.05, 0.0), (0.0, -0.05), (0.0, 0.05))
    )
    covered_m2 = np.abs(np.cross(right - left, down - up)) / 0.1**2
    near = slice(24, HEIGHT_PX)
    np.testing.assert_allclose((across_m * along_m)[near], covered_m2[near], rtol=0.01)


# The filter


def _share_left_of(x_px: float, reach_px: float) -> float:
    """Closed form of the integral of the Blackman-Harris window (Harris 1978, minimum 4-term) from its left end."""
    a, angle = (0.35875, 0.48829, 0.14128, 0.01168), np.pi * x_px / reach_px
    waves = sum(a[k] * np.sin(k * angle) / (k * np.pi) for k in (1, 2, 3))
    return 0.5 + 0.5 * (x_px / reach_px + waves / a[0])


def _variance_px2(reach_px: float) -> float:
    """Of the same window."""
    a = (0.35875, 0.48829, 0.14128, 0.01168)
    return reach_px**2 * (1 / 3 + 2 / (a[0] * np.pi**2) * sum((-1) ** k * a[k] / k**2 for k in (1, 2, 3)))


def test_the_closed_forms_are_those_of_the_window():
    x = np.linspace(-1.5, 1.5, 100_001)
    window_at = 0.35875 + sum(a * np.cos(k * np.pi * x / 1.5) for k, a in ((1, 0.48829), (2, 0.14128), (3, 0.01168)))
    assert np.average(x**2, weights=window_at) == pytest.approx(_variance_px2(1.5), rel=1e-3)
    assert window_at[x < 0.3].sum() / window_at.sum() == pytest.approx(_share_left_of(0.3, 1.5), abs=1e-4)


@pytest.mark.parametrize("width_px", [1.5, 1.0])
def test_points_of_the_filter_stand_in_the_middle_of_equal_shares_of_it(width_px):
    """Cycles' window is 0 one width from the pixel's middle: `filter_width` is half of what it reaches over."""
    points, reach = filter_points(width_px), width_px
    assert len(points) == 9
    for axis in ("right_px", "down_px"):
        offsets = np.array([getattr(point, axis) for point in points])
        assert np.abs(offsets).max() < reach
        assert offsets.mean() == pytest.approx(0.0, abs=1e-3)
        own, counts = np.unique(offsets, return_counts=True)
        assert counts.tolist() == [3, 3, 3]
        assert [_share_left_of(x, reach) for x in own] == pytest.approx([1 / 6, 1 / 2, 5 / 6], abs=1e-3)
        # Quantiles lack the ends of the window, which the map's own texels, up to a pixel in size, blur in their stead.
        assert 0.65 < offsets.var() / _variance_px2(reach) < 1.0


def test_the_points_of_the_filter_make_a_grid():
    assert len({(point.right_px, point.down_px) for point in filter_points(1.5)}) == 9


def test_each_point_of_the_filter_has_a_time_of_its_own_that_has_little_to_do_with_its_place():
    """Were the points of one side early, an edge in motion would be sharper on its way to one side than the other."""
    points = filter_points(1.5)
    times = np.array([point.time for point in points])
    np.testing.assert_allclose(np.sort(times), (np.arange(9) + 0.5) / 9)
    for axis in ("right_px", "down_px"):
        offsets = np.array([getattr(point, axis) for point in points])
        assert abs(np.corrcoef(offsets, times)[0, 1]) < 1e-9


@pytest.mark.parametrize("squares", [2, 3])
def test_a_slanted_filter_has_more_rows_of_points(squares):
    """In the middle of equal shares too, and of times that are all different and on no side early."""
    points = filter_points(1.5, squares)
    down, times = (np.array([getattr(point, of) for point in points]) for of in ("down_px", "time"))
    own, counts = np.unique(down, return_counts=True)
    assert counts.tolist() == [3] * (3 * squares)
    shares = (np.arange(3 * squares) + 0.5) / (3 * squares)
    assert [_share_left_of(y, 1.5) for y in own] == pytest.approx(shares, abs=1e-3)
    right = [point.right_px for point in points]
    assert sorted(set(right)) == [point.right_px for point in filter_points(1.5)[:3]]
    np.testing.assert_allclose(np.sort(times), (np.arange(9 * squares) + 0.5) / (9 * squares))
    assert abs(np.corrcoef(right, times)[0, 1]) < 1e-9
    assert abs(np.corrcoef(down, times)[0, 1]) < 0.1


# The shutter


def test_without_a_rolling_shutter_all_rows_go_through_the_moments_of_the_view(camera, arena, X_RC, view, path):
    shutter = replace(SHUTTER, read_out_s=0.0)
    (open_,) = exposed([view], arena, X_RC, path, window(shutter, camera))
    sight = FloorSight(camera, open_, window(shutter, camera).row_share)
    for time, number in ((0.0, 0), (0.25, 1), (0.5, 2), (1.0, 4)):
        found = sight.points(open_, FilterPoint(0.2, -0.3, time))
        _agree(found, _seen(camera, open_.exposure[number].X_WC, 0.2, -0.3))


def test_in_an_instant_the_time_does_not_matter(camera, view):
    sight = FloorSight(camera, view, 1.0)
    np.testing.assert_array_equal(
        sight.points(view, FilterPoint(0.0, 0.0, 0.0)), sight.points(view, FilterPoint(0.0, 0.0, 1.0))
    )


def test_with_a_rolling_shutter_each_row_is_seen_when_it_is_exposed(camera, arena, X_RC, view, path):
    (open_,) = exposed([view], arena, X_RC, path, window(SHUTTER, camera))
    sight = FloorSight(camera, open_, window(SHUTTER, camera).row_share)
    for time in (0.0, 0.3, 1.0):
        found = sight.points(open_, FilterPoint(0.0, 0.0, time))
        for row in (15, 24, HEIGHT_PX - 1):
            at_s = T_S + SHUTTER.row_opens_s(row, HEIGHT_PX) + time * SHUTTER.exposure_s
            x, y, yaw = path.poses_at(np.array([at_s]))[0]
            expected = _seen(camera, pose_X_WR(x, y, yaw) @ X_RC, rows=[row])[0]
            away = np.linalg.norm(expected - (x, y), axis=-1, keepdims=True)
            # Between moments the way is straight: off by (0.0225 rad)^2 / 8 at most.
            assert np.nanmax(np.abs(found[row] - expected) / away) < 1e-4
    # In the time between two rows' exposures the image turns by more than that tolerance.
    assert RATE_RAD_S * SHUTTER.read_out_s / HEIGHT_PX > 1e-3


def test_a_turn_through_half_a_turn_goes_the_short_way(camera, arena, X_RC, view):
    """Yaw is wrapped at pi."""
    poses = [(0.0, 0.0, yaw) for yaw in (3.12, 3.13, 3.14, -3.1331853, -3.1231853)]
    moments = tuple(moment(arena, X_RC, pose, 0.0) for pose in poses)
    turning = replace(view, exposure=moments)
    found = FloorSight(camera, view, 1.0).points(turning, FilterPoint(0.0, 0.0, 0.625))
    expected = _seen(camera, pose_X_WR(0.0, 0.0, 3.145) @ X_RC)
    near = np.linalg.norm(expected, axis=-1) < 20
    np.testing.assert_allclose(found[near], expected[near], atol=1e-4)


@pytest.mark.parametrize("kept", [0, 2])
def test_points_of_large_images_which_are_not_cached_are_the_same(monkeypatch, camera, view, kept):
    points = filter_points(1.5)
    whole = [FloorSight(camera, view, 1.0).points(view, point) for point in points]
    monkeypatch.setattr("blender_scenes.hybrid.floor.sight._MAX_BYTES", kept * 8 * WIDTH_PX * HEIGHT_PX)
    sight = FloorSight(camera, view, 1.0)
    for _ in range(2):
        for point, expected in zip(points, whole, strict=True):
            for rows in (slice(None), slice(5, 9), slice(20, 36)):
                np.testing.assert_array_equal(sight.points(view, point, rows), expected[rows])
