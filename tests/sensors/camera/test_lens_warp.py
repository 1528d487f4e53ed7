"""The pinhole image and the warp, without Blender."""

import cv2
import numpy as np
import pytest

from sensors.camera.lens_warp import pinhole_image, through_lens
from symolo.core.geometry.pinhole import Intrinsics

PINHOLE = Intrinsics(80, 60, 57.0, 57.0, 41.0, 28.0)
BARREL = Intrinsics(80, 60, 57.0, 57.0, 41.0, 28.0, (-0.3, 0.1, 0.002, -0.001, -0.01))
PINCUSHION = Intrinsics(80, 60, 57.0, 57.0, 41.0, 28.0, (0.2, 0.05, 0.0, 0.0, 0.0))


def test_without_distortion_nothing_is_added_and_nothing_changed():
    light = np.arange(60 * 80 * 3, dtype=np.float32).reshape(60, 80, 3)
    assert pinhole_image(PINHOLE).camera == PINHOLE
    assert through_lens(light, PINHOLE) is light


@pytest.mark.parametrize("lens", [BARREL, PINCUSHION])
def test_each_pixel_takes_the_light_of_its_undistorted_ray(lens):
    found = pinhole_image(lens)
    v, u = np.indices((found.camera.height_px, found.camera.width_px), dtype=np.float32)
    taken = through_lens(np.stack([u, v, np.zeros_like(u)], axis=-1), lens)[..., :2].reshape(-1, 2)
    K = np.array([[57.0, 0, 41.0], [0, 57.0, 28.0], [0, 0, 1]])
    rays = (taken - (found.camera.cx_px, found.camera.cy_px)) / 57.0
    points = np.column_stack([rays, np.ones(len(rays))]).astype(float)
    back, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, np.array(lens.distortion))
    v, u = np.indices((60, 80))
    # OpenCV's bilinear remap rounds places to 1/32 px.
    assert back[:, 0] == pytest.approx(np.stack([u.ravel(), v.ravel()], axis=1), abs=0.06)


def test_the_margin_is_as_wide_as_the_outermost_ray_and_no_pixel_lacks_light():
    lit = pinhole_image(BARREL)
    assert lit.left_px > 5
    assert lit.camera.width_px > 80 + 10
    assert through_lens(np.ones((lit.camera.height_px, lit.camera.width_px, 3), np.float32), BARREL).min() == 1.0
    assert pinhole_image(PINCUSHION).camera.width_px == 80  # which sees less than the pinhole


@pytest.mark.parametrize("k1", [-0.05, -0.1, -0.2, 0.2])
@pytest.mark.parametrize("times", [1, 2])
def test_its_sides_can_be_halved_until_light_has_80_to_160_pixels_across(k1, times):
    focal_px = 453.6 * times
    lens = Intrinsics(
        640 * times, 480 * times, focal_px, focal_px, 325.0 * times, 238.0 * times, (k1, 0.02, 0.001, 0.0, 0.0)
    )
    found = pinhole_image(lens)
    share = 8 * times
    assert 80 <= found.camera.width_px / share < 160
    assert (found.camera.width_px % share, found.camera.height_px % share) == (0, 0)
    assert (found.camera.cx_px, found.camera.cy_px) == (325.0 * times + found.left_px, 238.0 * times + found.top_px)


def test_light_that_lies_beyond_the_margin_is_that_of_the_border():
    """As where a rolling shutter is late in a fast turn."""
    lit = pinhole_image(BARREL).camera
    late = np.full((60, 80, 2), 30.0, np.float32)
    assert through_lens(np.ones((lit.height_px, lit.width_px, 3), np.float32), BARREL, late).min() == 1.0


def test_a_lens_that_folds_the_image_is_an_error():
    with pytest.raises(ValueError, match="no ray"):
        pinhole_image(Intrinsics(80, 60, 57.0, 57.0, 39.5, 29.5, (-0.8, 0.0, 0.0, 0.0, 0.0)))
