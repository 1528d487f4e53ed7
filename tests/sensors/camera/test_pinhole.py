from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter
from scipy.spatial.transform import Rotation

from configs.schema.robot import FisheyeLens
from symolo.core.geometry.pinhole import (
    Intrinsics,
    Shutter,
    floor_points,
    horizontal_field_of_view_rad,
    intrinsics,
    matrix_K,
    pose_X_RC,
    project,
    rays_of,
)
from symolo.core.geometry.poses import pose_X_WR


def _X_WC(robot, x=0.0, y=0.0, yaw=0.0):
    return pose_X_WR(x, y, yaw) @ pose_X_RC(robot.camera, robot.chassis.base_height_m)


def test_the_field_of_view_is_that_of_simtwo(robot):
    assert np.degrees(horizontal_field_of_view_rad(robot.camera)) == pytest.approx(70.4, abs=0.05)  # paper section 8.1


def test_the_border_of_the_image_is_half_the_field_of_view_away(robot):
    camera = intrinsics(robot.camera, 640, 480)
    right_border = 640 - 0.5  # pixel (0, 0) is the middle of the first pixel
    angle = np.arctan((right_border - camera.cx_px) / camera.fx_px)
    assert 2 * angle == pytest.approx(horizontal_field_of_view_rad(robot.camera))


def test_the_floor_point_on_the_axis_is_in_the_middle_of_the_image(robot):
    # The camera stands 0.12 m high at x = 0.05 and looks 30 degrees down: 0.12 / tan 30 further on it meets the floor.
    point = np.array([[0.05 + 0.12 / np.tan(np.radians(30)), 0.0, 0.0]])
    pixel, depth = project(intrinsics(robot.camera, 640, 480), _X_WC(robot), point)
    assert pixel[0] == pytest.approx([319.5, 239.5])
    assert depth[0] == pytest.approx(0.12 / np.sin(np.radians(30)))


@pytest.mark.parametrize(("row", "ahead_m"), [(-0.5, 3.248), (239.5, 0.2078), (479.5, 0.0753)])
def test_the_image_shows_the_floor_from_close_ahead_to_a_few_metres(robot, row, ahead_m):
    """0.12 / tan(30 degrees + atan((row - 239.5) / 453.6)), from the upper border to the lower one."""
    point = np.array([[0.05 + ahead_m, 0.0, 0.0]])
    pixel, _ = project(intrinsics(robot.camera, 640, 480), _X_WC(robot), point)
    assert pixel[0] == pytest.approx([319.5, row], abs=0.3)


def test_a_floor_point_at_a_known_pose_by_closed_form(robot):
    # 1 m ahead of the camera and 0.2 m to its left, seen from a robot at (0.3, -0.4) that looks along +y.
    p_W = np.array([[0.3 - 0.2, -0.4 + 0.05 + 1.0, 0.0]])
    pixel, depth = project(intrinsics(robot.camera, 640, 480), _X_WC(robot, 0.3, -0.4, np.pi / 2), p_W)
    c, s, focal = np.cos(np.radians(30)), 0.5, 640 * 30 / 42.33
    along = 1.0 * c + 0.12 * s
    assert depth[0] == pytest.approx(along)
    assert pixel[0, 0] == pytest.approx(319.5 - focal * 0.2 / along)
    assert pixel[0, 1] == pytest.approx(239.5 + focal * (0.12 * c - 1.0 * s) / along)


def test_the_optical_frame_has_x_right_y_down_z_forward(robot):
    X_RC = pose_X_RC(robot.camera, robot.chassis.base_height_m)
    assert X_RC[:3, 0] == pytest.approx([0, -1, 0])  # the robot's right
    assert X_RC[2, 1] < 0 < X_RC[0, 2]  # down and forward
    assert X_RC[:3, :3] @ X_RC[:3, :3].T == pytest.approx(np.eye(3))
    assert np.linalg.det(X_RC[:3, :3]) == pytest.approx(1)
    assert X_RC[:3, 3] == pytest.approx([0.05, 0.0, 0.12])
    assert not np.signbit(X_RC[X_RC == 0.0]).any()  # a table of poses has no -0


def test_the_matrix_projects_as_the_function_does(robot):
    camera, X_WC = intrinsics(robot.camera, 320, 240), _X_WC(robot, 0.1, 0.2, 0.3)
    p_W = np.array([[0.9, 0.4, 0.05], [0.6, 0.5, 0.0]])
    p_C = (np.linalg.inv(X_WC) @ np.column_stack([p_W, np.ones(2)]).T)[:3]
    homogeneous = matrix_K(camera) @ p_C
    assert project(camera, X_WC, p_W)[0] == pytest.approx((homogeneous[:2] / homogeneous[2]).T)


@given(x=st.floats(-2, 2), y=st.floats(-2, 2), yaw=st.floats(-7, 7), u=st.floats(0, 159), v=st.floats(5, 119))
def test_a_pixel_goes_to_the_floor_and_back(robot, x, y, yaw, u, v):
    camera, X_WC = intrinsics(robot.camera, 160, 120), _X_WC(robot, x, y, yaw)
    point = floor_points(camera, X_WC, np.array([[u, v]]))
    assert point[0, 2] == pytest.approx(0, abs=1e-9)
    assert project(camera, X_WC, point)[0][0] == pytest.approx([u, v], abs=1e-6)


def test_a_ray_above_the_horizon_meets_no_floor(robot):
    level = robot.camera.model_copy(update={"pitch_down_deg": 0.0})
    X_RC = pose_X_RC(level, 0.05)
    assert np.isnan(floor_points(intrinsics(level, 160, 120), X_RC, np.array([[80.0, 10.0]]))).all()


def test_a_point_behind_the_camera_has_negative_depth(robot):
    pixel, depth = project(intrinsics(robot.camera, 160, 120), _X_WC(robot), np.array([[-1.0, 0.0, 0.1]]))
    assert depth[0] < 0
    assert np.isnan(pixel).all()


TURNS = (("z", 20.0), ("y", 30.0), ("z", 10.0))
LENS = (-0.3, 0.1, 0.001, -0.002, -0.01)


def _behind_a_lens(robot):
    mm = robot.camera.sensor_width_mm / 160
    moved = {"principal_point_right_mm": 5 * mm, "principal_point_down_mm": -3 * mm}
    camera = intrinsics(robot.camera.model_copy(update=moved), 160, 120)
    return replace(camera, distortion=LENS)


def test_the_principal_point_is_off_the_middle_by_what_the_camera_says(robot):
    camera = _behind_a_lens(robot)
    assert (camera.cx_px, camera.cy_px) == pytest.approx((79.5 + 5, 59.5 - 3))


@pytest.mark.parametrize("lens", [LENS, (0.2, 0.0, 0.0, 0.0, 0.0)], ids=["barrel", "pincushion"])
def test_points_behind_a_lens_project_as_opencv_does(robot, lens):
    camera, X_WC = replace(_behind_a_lens(robot), distortion=lens), _X_WC(robot, 0.1, 0.2, 0.3)
    p_W = np.array([[0.9, 0.4, 0.05], [0.6, 0.5, 0.0], [0.35, 0.35, 0.02]])
    X_CW = np.linalg.inv(X_WC)
    turn, _ = cv2.Rodrigues(X_CW[:3, :3])
    expected, _ = cv2.projectPoints(p_W, turn, X_CW[:3, 3], matrix_K(camera), np.array(lens))
    assert project(camera, X_WC, p_W)[0] == pytest.approx(expected[:, 0], abs=1e-6)


def test_pixels_behind_a_lens_go_to_the_floor_and_back(robot):
    camera, X_WC = _behind_a_lens(robot), _X_WC(robot)
    u, v = np.meshgrid(np.linspace(0, 159, 20), np.linspace(30, 119, 15))
    pixels = np.column_stack([u.ravel(), v.ravel()])
    points = floor_points(camera, X_WC, pixels)
    assert points[:, 2] == pytest.approx(0, abs=1e-9)
    assert project(camera, X_WC, points)[0] == pytest.approx(pixels, abs=1e-6)


def test_a_point_that_the_lens_would_fold_back_into_the_image_has_no_pixel(robot):
    # r (1 - 0.15 r^2) rises up to 1.49 and is back at 0.45 for r = 2.3, seen within the image where nothing is.
    camera = replace(intrinsics(robot.camera, 160, 120), distortion=(-0.15, 0.0, 0.0, 0.0, 0.0))
    X_WC = _X_WC(robot)
    points = X_WC[:3, 3] + np.array([[0.4, 0.0, 1.0], [2.3, 0.0, 1.0]]) @ X_WC[:3, :3].T
    pixel, depth = project(camera, X_WC, points)
    assert np.isnan(pixel).any(axis=1).tolist() == [False, True]
    assert depth == pytest.approx([1, 1])


@pytest.mark.parametrize("x_m", [2.0, 3.0, 3.5, 5.0, 40.0])
def test_a_point_far_beyond_the_lens_fold_has_no_pixel_either(robot, x_m):
    """Off by 1.667 = 1 / sqrt(3 * 0.12) the radius x (1 - 0.12 x^2) falls again; beyond 2.9 it is negative."""
    camera = replace(intrinsics(robot.camera, 160, 120), distortion=(-0.12, 0.0, 0.0, 0.0, 0.0))
    pixels, _ = project(camera, np.eye(4), np.array([[x_m, 0.0, 1.0]]))
    assert np.isnan(pixels).all()


def test_pitch_yaw_and_roll_are_turns_about_left_up_and_the_axis(robot):
    turned = robot.camera.model_copy(update={"pitch_down_deg": 30.0, "yaw_left_deg": 20.0, "roll_deg": 10.0})
    level = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    about_up, about_left, about_axis = (Rotation.from_euler(*turn, degrees=True).as_matrix() for turn in TURNS)
    assert pose_X_RC(turned, 0.05)[:3, :3] == pytest.approx(about_up @ about_left @ level @ about_axis)


def test_a_camera_turned_to_the_left_looks_there(robot):
    turned = robot.camera.model_copy(update={"yaw_left_deg": 90.0, "pitch_down_deg": 0.0})
    assert pose_X_RC(turned, 0.05)[:3, 2] == pytest.approx([0.0, 1.0, 0.0])


def test_a_camera_rolled_clockwise_sees_what_was_right_further_up(robot):
    def pixel(roll_deg):
        rolled = robot.camera.model_copy(update={"roll_deg": roll_deg, "pitch_down_deg": 0.0})
        X_RC = pose_X_RC(rolled, 0.05)
        ahead_and_right = X_RC[:3, 3] + [1.0, -0.2, 0.0]
        lens = intrinsics(rolled, 160, 120)
        return project(lens, X_RC, ahead_and_right[None])[0][0] - (lens.cx_px, lens.cy_px)

    size = float(np.hypot(*pixel(0.0)))
    assert pixel(0.0) == pytest.approx([size, 0.0], abs=1e-9)
    assert pixel(30.0) == pytest.approx([size * np.sqrt(0.75), -0.5 * size])


def test_the_middle_of_the_middle_row_is_exposed_at_the_time_of_the_view():
    shutter = Shutter(exposure_s=0.01, read_out_s=0.03)
    # Three rows of 10 ms each, so that the exposures begin 15 ms early, 5 ms early, and 5 ms late.
    assert [shutter.row_opens_s(row, 3) for row in range(3)] == pytest.approx([-0.015, -0.005, 0.005])
    assert Shutter().row_opens_s(0, 480) == Shutter().row_opens_s(479, 480) == 0.0


def test_pixels_see_along_the_rays_of_opencv(robot):
    for camera in (intrinsics(robot.camera, 160, 120), _behind_a_lens(robot)):
        pixels = np.array([[3.0, 110.0], [84.5, 56.5], [150.0, 20.0]])
        K, lens, until = matrix_K(camera), np.array(camera.distortion), (cv2.TERM_CRITERIA_COUNT, 200, 0.0)
        expected = cv2.undistortPointsIter(pixels[:, None], K, lens, np.eye(3), np.eye(3), until)
        assert rays_of(camera, pixels) == pytest.approx(expected[:, 0], abs=1e-6)


def test_a_point_at_the_height_of_the_pinhole_has_no_pixel(robot):
    pixel, depth = project(intrinsics(robot.camera, 160, 120), np.eye(4), np.array([[0.1, 0.1, 0.0]]))
    assert np.isnan(pixel).all()
    assert depth[0] == 0.0


def test_intrinsics_name_a_fisheye_lens_only_where_there_is_one(robot):
    """As in files of versions without fisheye lenses; its field of view spans the width of the image."""
    text = TypeAdapter(Intrinsics)
    pinhole = intrinsics(robot.camera, 160, 120)
    wide = intrinsics(robot.camera.model_copy(update={"fisheye": FisheyeLens(field_of_view_deg=180.0)}), 160, 120)
    assert "fisheye" not in text.dump_python(pinhole, mode="json")
    for camera in (pinhole, wide):
        assert text.validate_json(text.dump_json(camera)) == camera
    # An equidistant lens shows half of 180 degrees on half of 160 pixels.
    assert wide.fx_px * np.pi / 2 == pytest.approx(80.0)


def test_intrinsics_and_a_shutter_cannot_be_changed(changeable):
    for kind in (Intrinsics, Shutter):
        assert changeable(kind) == []
