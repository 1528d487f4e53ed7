"""Fisheye lenses against OpenCV's module `fisheye`, and behind the camera against closed forms."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.pinhole import Intrinsics, directions_of, floor_points, matrix_K, project

BENT = Fisheye(np.radians(80.0), (0.05, -0.02, 0.004, -0.0005))
CAMERA = Intrinsics(320, 240, 110.0, 110.0, 161.0, 117.5, fisheye=BENT)
IN_FRONT = np.random.Generator(np.random.PCG64(3)).uniform((-2.0, -2.0, 0.5), (2.0, 2.0, 3.0), (200, 3))


def test_points_fall_where_opencv_projects_them():
    expected, _ = cv2.fisheye.projectPoints(
        IN_FRONT[None], np.zeros(3), np.zeros(3), matrix_K(CAMERA), np.array(BENT.k)
    )
    pixels, distance_m = project(CAMERA, np.eye(4), IN_FRONT)
    np.testing.assert_allclose(pixels, expected[0], atol=1e-9)
    np.testing.assert_allclose(distance_m, np.linalg.norm(IN_FRONT, axis=1))


@pytest.mark.parametrize("lens", [BENT, Fisheye(np.radians(92.5))])
def test_the_directions_of_pixels_are_those_of_the_points_seen_there(lens):
    camera = replace(CAMERA, fisheye=lens)
    pixels, distance_m = project(camera, np.eye(4), IN_FRONT)
    np.testing.assert_allclose(directions_of(camera, pixels) * distance_m[:, None], IN_FRONT, atol=1e-9)


def test_an_equidistant_lens_shows_angles_in_proportion_and_nothing_beyond_its_field_of_view():
    camera = Intrinsics(
        181, 181, 90 / np.radians(92.5), 90 / np.radians(92.5), 90.0, 90.0, fisheye=Fisheye(np.radians(92.5))
    )
    angles = np.radians([0.0, 46.25, 91.0, 92.5, 92.6, 180.0])
    points = np.column_stack([np.sin(angles), 0 * angles, np.cos(angles)])
    pixels, distance_m = project(camera, np.eye(4), points)
    np.testing.assert_allclose(pixels[:4, 0] - 90.0, [0.0, 45.0, 90.0 * 91.0 / 92.5, 90.0], atol=1e-9)
    assert np.isnan(pixels[4:]).all()
    assert (distance_m > 0).tolist() == [True, True, True, True, False, False]
    assert np.isnan(directions_of(camera, np.array([[90.0 + 64.0, 90.0 + 64.0]]))).all()


def test_a_level_camera_sees_the_floor_below_the_horizon_only():
    camera = Intrinsics(181, 181, 60.0, 60.0, 90.0, 90.0, fisheye=Fisheye(np.radians(86.0)))
    X_WC = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, 0, 1]])  # along x, 0.2 m above the floor
    pixels = np.array([[90.0, 90.0 + 60.0 * np.pi / 4], [90.0, 80.0]])
    floor = floor_points(camera, X_WC, pixels)
    np.testing.assert_allclose(floor[0], [0.2, 0.0, 0.0], atol=1e-12)  # 45 degrees down
    assert np.isnan(floor[1]).all()


def test_a_lens_that_folds_the_image_back_is_refused():
    # t - 0.3 t^3 falls from t = 1 / sqrt(0.9) on, 60.4 degrees.
    assert "folds" in Fisheye(np.radians(61.0), (-0.3, 0.0, 0.0, 0.0)).problem()
    assert not Fisheye(np.radians(60.0), (-0.3, 0.0, 0.0, 0.0)).problem()
