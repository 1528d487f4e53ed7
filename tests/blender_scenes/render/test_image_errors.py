"""The estimate of a mean square error from noisy references, on images with known errors."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from blender_scenes.render.image_errors import ImageError, image_error, square_errors
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
    measured = image_error(TRUTH * (1 + error), _references(), RESPONSE, METERED, 1).rendering
    expected = (_grey(METERED * (1 + error)) - _grey(METERED)) ** 2
    # The estimate of 20,000 values with this noise has a standard error of about 0.1 squared grey values.
    assert measured == pytest.approx(expected, rel=0.1, abs=0.5)


@pytest.mark.parametrize("error", [0.0, 0.05])
def test_the_tone_curve_does_not_make_an_error_of_the_noise_of_few_samples(error):
    """Noise as large as the light has the right mean as light, but not as grey values: the curve is bent."""
    few = [RANDOM.gamma(2.0, METERED / 2.0, (288, 384, 3)).astype(np.float32) for _ in range(2)]
    light = np.full_like(few[0], METERED * (1 + error))
    measured = image_error(light, few, RESPONSE, METERED, 1).rendering
    # The standard deviation of a difference is some 30 grey values, so the mean of their products varies by 1.6.
    assert measured == pytest.approx((_grey(METERED * (1 + error)) - _grey(METERED)) ** 2, abs=5)


def test_four_references_leave_a_sixth_of_the_variance_that_two_leave():
    """They have six pairs, whose products are uncorrelated: two differences with a mean of zero are."""
    references = [TRUTH + RANDOM.normal(0, NOISE_SD, TRUTH.shape).astype(np.float32) for _ in range(4)]
    two, four = (square_errors(TRUTH, references[:count], RESPONSE, METERED).var() for count in (2, 4))
    # Ten repetitions gave 1.00 to 1.03 times the sixth.
    assert four == pytest.approx(two / 6, rel=0.08)


def test_the_standard_error_counts_rare_bright_pixels_wherever_they_may_be():
    """One pixel of 500 is 100 times as bright: its share of the light is rarely seen in two references at once."""
    pinhole = replace(RESPONSE, lens_blur_px=0.0, veiling_glare=0.0, sharpening=0.0)

    def estimate() -> ImageError:
        bright = (RANDOM.random((4, *TRUTH.shape[:2], 1)) < 0.002).astype(np.float32)
        references = METERED * np.repeat(1 + 0.3 * (bright - 0.002), 3, axis=-1)
        return image_error(TRUTH, references, pinhole, METERED, 1)

    estimates = [estimate() for _ in range(100)]
    # Noise of two values has the variance share * (1 - share) * step^2, so the products have the square of it.
    step = _grey(METERED * 1.001) - _grey(METERED)
    expected = 0.002 * 0.998 * (300 * step) ** 2 / (6 * TRUTH[..., 0].size) ** 0.5
    # It is never less than for noise that is alike everywhere, so it is a little too large on average.
    assert 0.95 < np.mean([each.standard_error for each in estimates]) / expected < 1.2
    assert np.std([each.rendering for each in estimates]) == pytest.approx(expected, rel=0.4)
    assert np.median([each.rendering for each in estimates]) < 0


@pytest.mark.parametrize("blur_px", [0.0, 0.8, 1.5])
def test_the_standard_error_counts_that_a_lens_spreads_noise_over_neighbours(blur_px):
    """White noise of variance s2 behind a Gaussian with the autocorrelation g has the covariance s2 g(x) g(y) at a
    distance (x, y). Products of two such noises have its square, so the variance of the mean over N pixels and six
    pairs is s2^2 (sum of g^2)^2 / (6 N)."""
    lens = replace(RESPONSE, lens_blur_px=blur_px, veiling_glare=0.0, sharpening=0.0)

    def estimate() -> ImageError:
        noise = RANDOM.normal(0, NOISE_SD, (4, *TRUTH.shape[:2], 1)).astype(np.float32)
        return image_error(TRUTH, list(TRUTH + noise), lens, METERED, 1)

    estimates = [estimate() for _ in range(100)]
    radius = 8
    kernel = cv2.getGaussianKernel(2 * radius + 1, blur_px)[:, 0] if blur_px else np.eye(1)[0]
    spread = np.sum(np.correlate(kernel, kernel, "full") ** 2)
    step = _grey(METERED * 1.001) - _grey(METERED)
    expected = (1000 * NOISE_SD / METERED * step) ** 2 * spread / (6 * TRUTH[..., 0].size) ** 0.5
    # OpenCV mirrors the image at its borders, where the noise is larger therefore.
    assert np.mean([each.standard_error for each in estimates]) == pytest.approx(expected, rel=0.08)
    # A standard deviation of 100 values is uncertain by 7 %.
    assert np.std([each.rendering for each in estimates]) == pytest.approx(expected, rel=0.2)


def test_the_standard_error_counts_the_noise_on_an_error_that_the_image_has():
    """The mean product of differences e + n from four references with noise n of variance s2 has, beside the noise of
    the products, the part e * (mean of n) * 2, whose variance is 4 e^2 s2 / (4 N)."""
    pinhole = replace(RESPONSE, lens_blur_px=0.0, veiling_glare=0.0, sharpening=0.0)
    light = TRUTH * np.float32(1.2)

    def estimate() -> ImageError:
        noise = RANDOM.normal(0, NOISE_SD, (4, *TRUTH.shape[:2], 1)).astype(np.float32)
        return image_error(light, list(TRUTH + noise), pinhole, METERED, 1)

    estimates = [estimate() for _ in range(100)]
    slope = (_grey(METERED * 1.201) - _grey(METERED * 1.199)) / (0.002 * METERED)
    error, noise_sd = 0.2 * METERED * slope, NOISE_SD * slope
    expected = ((noise_sd**4 / 6 + error**2 * noise_sd**2) / TRUTH[..., 0].size) ** 0.5
    assert np.mean([each.standard_error for each in estimates]) == pytest.approx(expected, rel=0.05)
    assert np.std([each.rendering for each in estimates]) == pytest.approx(expected, rel=0.2)


def _sd_by_place(place: str) -> np.ndarray:
    """Return the standard deviation (H, W, 1) of the light's noise."""
    sd = np.zeros((*TRUTH.shape[:2], 1), np.float32)
    if place == "an eighth of the columns":
        sd[:, 40:52] = NOISE_SD
    elif place == "one block":
        sd[24:44, 30:50] = NOISE_SD
    else:
        sd[:] = np.linspace(0, NOISE_SD, TRUTH.shape[1])[:, np.newaxis]
    return sd


@pytest.mark.parametrize("place", ["an eighth of the columns", "one block", "from left to right"])
@pytest.mark.parametrize("relative_error", [0.0, 2.0])
def test_the_standard_error_counts_that_noise_is_uneven(place, relative_error):
    """White noise of variance s2(x) on an error e(x) leaves the variance (sum s2^2 / 6 + sum e^2 s2) / N^2 in the mean
    product over the pairs of four references. Here the error is where the noise is, or there is none."""
    pinhole = replace(RESPONSE, lens_blur_px=0.0, veiling_glare=0.0, sharpening=0.0)
    sd = _sd_by_place(place)
    light = TRUTH + np.float32(relative_error) * sd

    def estimate() -> ImageError:
        noise = RANDOM.normal(0, 1, (4, *sd.shape)).astype(np.float32) * sd
        return image_error(light, list(TRUTH + noise), pinhole, METERED, 1)

    estimates = [estimate() for _ in range(60)]
    slope = np.vectorize(lambda each: (_grey(each * 1.001) - _grey(each * 0.999)) / (0.002 * each))(light[..., :1])
    variance, square = (slope * sd) ** 2, (slope * relative_error * sd) ** 2
    expected = np.sum(variance**2 / 6 + square * variance) ** 0.5 / sd.size
    assert np.mean([each.standard_error for each in estimates]) == pytest.approx(expected, rel=0.1)
    # A standard deviation of 60 values is uncertain by 9 %.
    assert np.std([each.rendering for each in estimates]) == pytest.approx(expected, rel=0.3)


def test_a_difference_from_one_reference_would_show_the_noise_instead():
    first, _ = _references()
    assert image_error(TRUTH, (first, first), RESPONSE, METERED, 1).rendering > 8


def test_the_noise_of_the_camera_makes_the_error_of_jpeg_larger_and_not_that_of_the_candidate():
    noisy = replace(RESPONSE, shot_noise=0.03)
    references = _references()
    calm, loud = (image_error(TRUTH, references, response, METERED, 1) for response in (RESPONSE, noisy))
    assert calm.rendering == loud.rendering
    assert loud.jpeg > calm.jpeg + 1
