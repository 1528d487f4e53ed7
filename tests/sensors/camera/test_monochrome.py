"""A sensor without colours: what it measures, its noise, and its images, by closed forms."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook
from sensors.camera.colour import as_measured
from sensors.camera.response import CameraResponse, compressed, develop, develop_part, inverse_tone

LOOK = CameraLook(
    contrast=1,
    vignetting=0,
    shot_noise=0,
    read_noise=0,
    brightness=0.18,
    exposure_adaption=0,
    colour_filter="monochrome",
)
COLOURED = np.random.default_rng(5).uniform(0.1, 0.9, (48, 64, 3)).astype(np.float32)


def response_of(look: CameraLook = LOOK, light=(1.0, 0.6, 0.2)) -> CameraResponse:
    return CameraResponse.from_look(look, light, 1, jpeg_quality=92)


def test_it_measures_red_green_and_blue_alike_whatever_the_white_balance_and_the_saturation():
    response = response_of(LOOK.model_copy(update={"saturation": 2.0, "white_balance_K": 2000.0}))
    grey = develop_part(COLOURED, response, metered=0.36, number=None)
    # The exposure brings 0.36 to 0.18; the code values follow from the transfer function of sRGB (IEC 61966-2-1).
    linear = 0.5 * COLOURED.astype(float).mean(axis=2)
    coded = 255 * (1.055 * linear ** (1 / 2.4) - 0.055)
    for channel in range(3):
        assert grey[..., channel] == pytest.approx(coded, abs=0.01)


def test_what_it_measures_of_a_colour_is_the_mean_of_the_components():
    assert as_measured(np.array([[[0.3, 0.6, 0.9]]], np.float32), "monochrome") == pytest.approx(0.6)
    assert as_measured(COLOURED, "bayer") is COLOURED


def test_an_image_has_no_colours_also_after_compression():
    noisy = LOOK.model_copy(
        update={"shot_noise": 0.05, "noise_reduction": 0.02, "colour_blur_px": 1.5, "sharpening": 1.0}
    )
    pixels = develop(COLOURED, response_of(noisy), 0.5, 1)
    for image in (pixels, compressed(pixels, 80)):
        assert np.array_equal(image[..., 0], image[..., 1])
        assert np.array_equal(image[..., 0], image[..., 2])
    assert np.ptp(pixels) > 50


def test_its_noise_is_independent_from_pixel_to_pixel():
    """Variance shot^2 x light + read^2 in linear values; no interpolation spreads it."""
    response = response_of(LOOK.model_copy(update={"shot_noise": 0.04, "read_noise": 0.01}))
    even = np.full((256, 256, 3), 0.36, np.float32)
    noisy = develop_part(even, replace(response, sharpening=0.0), metered=0.36, number=3)
    noise = inverse_tone(noisy[..., 0].astype(float) / 255, 1.0) - 0.18
    assert noise.var() == pytest.approx(0.04**2 * 0.18 + 0.01**2, rel=0.03)
    for axis in (0, 1):
        neighbours = np.mean(np.take(noise, range(255), axis) * np.take(noise, range(1, 256), axis)) / noise.var()
        assert abs(neighbours) < 0.02


def test_a_full_pixel_is_white():
    lamp = np.zeros((8, 8, 3), np.float32)
    lamp[2:6, 2:6] = (50.0, 20.0, 5.0)
    pixels = develop_part(lamp, response_of(), metered=0.18, number=None)
    assert np.all((pixels[2:6, 2:6] + 0.5).astype(np.uint8) == 255)
    assert cv2.cvtColor(pixels.astype(np.uint8), cv2.COLOR_RGB2HSV)[..., 1].max() == 0
