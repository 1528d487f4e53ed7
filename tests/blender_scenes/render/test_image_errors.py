"""The estimate of a mean square error from two noisy references, on images with known errors."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.image_errors import mean_square_errors
from configs.schema.appearance.look import CameraLook
from sensors.camera.response import CameraResponse

METERED = 0.3
RESPONSE = CameraResponse.from_look(CameraLook(white_balance_adaption=1.0), (1.0, 1.0, 1.0), 1, 92)
RANDOM = np.random.Generator(np.random.PCG64(7))
TRUTH = np.full((72, 96, 3), METERED, np.float32)
NOISE_SD = 0.015
"""A twentieth of the light, which is as much as the largest error that is estimated."""


def _references() -> tuple[np.ndarray, np.ndarray]:
    first, second = (TRUTH + RANDOM.normal(0, NOISE_SD, TRUTH.shape).astype(np.float32) for _ in range(2))
    return first, second


def _grey(light: float) -> float:
    """Return the grey value of even light without noise: sRGB of the exposed value, below the shoulder of the tone."""
    exposed = light / METERED * RESPONSE.brightness
    scaled = 0.18 * (exposed / 0.18) ** RESPONSE.contrast
    return 255 * (1.055 * scaled ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize("error", [0.0, 0.02, 0.05])
def test_the_error_of_a_candidate_is_found_below_the_noise_of_the_references(error):
    measured, _ = mean_square_errors(TRUTH * (1 + error), _references(), RESPONSE, METERED, 1)
    expected = (_grey(METERED * (1 + error)) - _grey(METERED)) ** 2
    # The estimate of 20,000 values with this noise has a standard error of about 0.1 squared grey values.
    assert measured == pytest.approx(expected, rel=0.1, abs=0.5)


@pytest.mark.parametrize("error", [0.0, 0.05])
def test_the_tone_curve_does_not_make_an_error_of_the_noise_of_few_samples(error):
    """Noise as large as the light has the right mean as light, but not as grey values: the curve is bent."""
    few = [RANDOM.gamma(2.0, METERED / 2.0, (288, 384, 3)).astype(np.float32) for _ in range(2)]
    light = np.full_like(few[0], METERED * (1 + error))
    measured, _ = mean_square_errors(light, (few[0], few[1]), RESPONSE, METERED, 1)
    # The standard deviation of a difference is some 30 grey values, so the mean of their products varies by 1.6.
    assert measured == pytest.approx((_grey(METERED * (1 + error)) - _grey(METERED)) ** 2, abs=5)


def test_a_difference_from_one_reference_would_show_the_noise_instead():
    first, _ = _references()
    measured, _ = mean_square_errors(TRUTH, (first, first), RESPONSE, METERED, 1)
    assert measured > 8


def test_the_noise_of_the_camera_makes_the_error_of_jpeg_larger_and_not_that_of_the_candidate():
    noisy = replace(RESPONSE, shot_noise=0.03)
    references = _references()
    calm, loud = (mean_square_errors(TRUTH, references, response, METERED, 1) for response in (RESPONSE, noisy))
    assert calm[0] == loud[0]
    assert loud[1] > calm[1] + 1
