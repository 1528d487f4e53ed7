"""The lens model against OpenCV's own implementation, and where it folds against closed forms."""

import cv2
import numpy as np
import pytest

from configs.schema.robot import Camera, LensDistortion
from symolo.core.geometry.lens import border_rays, distorted, lens_problem, undistorted

WEBCAM = (-0.32, 0.12, 0.001, -0.002, -0.02)
PINCUSHION = (0.2, 0.05, -0.003, 0.004, 0.01)


def _grid(reach: float) -> np.ndarray:
    x, y = np.meshgrid(np.linspace(-reach, reach, 15), np.linspace(-reach, reach, 15))
    return np.column_stack([x.ravel(), y.ravel()])


def _camera(**lens: float) -> Camera:
    place = {"x_m": 0.05, "y_m": 0.0, "height_above_base_m": 0.07, "pitch_down_deg": 30.0}
    return Camera(**place, focal_length_mm=30.0, sensor_width_mm=42.33, distortion=LensDistortion(**lens))


@pytest.mark.parametrize("lens", [WEBCAM, PINCUSHION])
def test_points_fall_where_opencv_projects_them(lens):
    rays = _grid(0.6)
    expected, _ = cv2.projectPoints(
        np.column_stack([rays, np.ones(len(rays))]), np.zeros(3), np.zeros(3), np.eye(3), np.array(lens)
    )
    assert distorted(lens, rays) == pytest.approx(expected[:, 0], abs=1e-12)


@pytest.mark.parametrize("lens", [WEBCAM, PINCUSHION])
def test_the_inverse_undoes_the_lens(lens):
    rays = _grid(0.6)
    assert undistorted(lens, distorted(lens, rays)) == pytest.approx(rays, abs=1e-9)


def test_the_inverse_ends_where_a_barrel_lens_folds_back():
    # r (1 - 0.3 r^2) rises up to r = 1 / sqrt(0.9), where it is two thirds of r.
    reach = 2 / 3 / np.sqrt(0.9)
    at = np.array([[0.999 * reach, 0], [0, -0.999 * reach], [1.001 * reach, 0], [0, -1.001 * reach]])
    assert np.isnan(undistorted((-0.3, 0, 0, 0, 0), at)).any(axis=1).tolist() == [False, False, True, True]


def test_a_fold_is_seen_even_where_the_model_rises_again_behind_it():
    # r (1 - r^2 + 0.27 r^4) falls between the roots of 1 - 3 r^2 + 1.35 r^4, and reaches 0.4 again beyond them.
    fold = np.sqrt((3 - np.sqrt(9 - 4 * 1.35)) / 2.7)
    top = fold * (1 - fold**2 + 0.27 * fold**4)
    at = np.array([[0.99 * top, 0.0], [1.05 * top, 0.0], [0.0, 1.5 * top]])
    assert np.isnan(undistorted((-1, 0.27, 0, 0, 0), at)).any(axis=1).tolist() == [False, True, True]


def test_the_border_encloses_every_ray():
    border = border_rays(WEBCAM, (-0.7, -0.5), (0.65, 0.55))
    inside = undistorted(WEBCAM, np.random.Generator(np.random.PCG64(1)).uniform((-0.7, -0.5), (0.65, 0.55), (500, 2)))
    assert np.all(inside.min(axis=0) >= border.min(axis=0))
    assert np.all(inside.max(axis=0) <= border.max(axis=0))


def test_a_lens_is_refused_that_folds_within_the_picture():
    # The corner of 640 x 480 lies at 0.882 focal lengths; r (1 + k1 r^2) gets there for k1 above -4 / (27 * 0.882^2).
    least = -4 / 27 / (0.5 * 42.33 / 30 * 1.25) ** 2
    assert lens_problem(_camera(), 640, 480) == ""
    assert lens_problem(_camera(k1=0.98 * least), 640, 480) == ""
    assert "folds" in lens_problem(_camera(k1=1.02 * least), 640, 480)
    assert "folds" in lens_problem(_camera(k1=1.0, k2=-1.0, k3=-1.0), 640, 480)
