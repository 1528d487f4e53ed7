"""The standard error of an estimated error where few pixels of the references are bright."""

import cv2
import numpy as np
import pytest

from blender_scenes.render.standard_error import standard_error

HEIGHT, WIDTH, BLOCK_PX = 120, 160, 16
SHARE, STEP = 0.002, 100.0
"""Share of bright pixels in the block, and by how much they are brighter."""
BLUR_PX = 0.8
TRIALS = 150


@pytest.fixture(scope="module")
def differences() -> np.ndarray:
    """Differences (TRIALS, 4, H, W, 1) from four references; in a block, each has about half a bright pixel."""
    random = np.random.Generator(np.random.PCG64(7))
    noise = np.zeros((TRIALS, 4, HEIGHT, WIDTH, 1), np.float32)
    bright = random.random((TRIALS, 4, BLOCK_PX, BLOCK_PX, 1)) < SHARE
    noise[:, :, 48 : 48 + BLOCK_PX, 72 : 72 + BLOCK_PX] = STEP * (bright - SHARE)
    images = noise.reshape(-1, HEIGHT, WIDTH)
    return np.array([cv2.GaussianBlur(each, (0, 0), BLUR_PX) for each in images]).reshape(noise.shape)


def test_the_standard_error_counts_rare_bright_pixels_in_a_small_part_of_an_image(differences):
    """White noise of variance v in M of N pixels leaves the variance M v^2 / (6 N^2) in the mean of six pairs.

    Behind a Gaussian with the autocorrelation g(x) g(y), it leaves the (sum of g^2)^2 of that. An eighth of the trials
    has no bright pixel at all, so the mean stays too small.
    """
    variance = SHARE * (1 - SHARE) * STEP**2
    kernel = cv2.getGaussianKernel(17, BLUR_PX)[:, 0]
    spread = np.sum(np.correlate(kernel, kernel, "full") ** 2)
    expected = (BLOCK_PX**2 / 6) ** 0.5 * variance * spread / (HEIGHT * WIDTH)
    measured = [standard_error(list(each)) for each in differences]
    assert 0.7 < np.mean(measured) / expected < 1.2


def test_few_upper_limits_are_negative(differences):
    """The true mean product is 0. 5 % are expected below, and fewer where the noise is skewed."""
    estimates = (differences.sum(axis=1) ** 2 - (differences**2).sum(axis=1)).mean(axis=(1, 2, 3)) / 12
    limits = estimates + 1.645 * np.array([standard_error(list(each)) for each in differences])
    assert np.mean(limits < -1e-9) < 0.05
