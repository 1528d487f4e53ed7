"""Noise reduction: what it takes away from even areas, and what it keeps of edges."""

import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook
from sensors.camera.post_processing import denoised
from sensors.camera.response import CameraResponse, develop

LUMA = np.array([0.299, 0.587, 0.114])


def noisy(sd):
    drawn = np.random.Generator(np.random.PCG64(5)).standard_normal((256, 256, 3))
    return (0.5 + sd * drawn).astype(np.float32)


def test_weak_noise_of_the_luma_becomes_the_mean_of_eight_means():
    """Four lines have five pixels, four have three; all eight count alike, and all have the middle pixel."""
    middle = (4 / 5 + 4 / 3) / 8
    squares = middle**2 + 16 * (1 / 5 / 8) ** 2 + 8 * (1 / 3 / 8) ** 2
    image = noisy(0.001)
    luma = denoised(image, 0.1, 0.0) @ LUMA
    assert luma.var() == pytest.approx(squares * (image @ LUMA).var(), rel=0.05)


def test_noise_far_above_the_contrast_stays():
    image = noisy(0.05)
    assert denoised(image, 0.002, 0.0) == pytest.approx(image, abs=0.01)


@pytest.mark.parametrize("slope", [0.0, 0.5, 1.0, -2.0])
def test_a_strong_edge_stays_and_loses_its_noise_along_itself(slope):
    """Along lines of five and three pixels, the standard deviation of noise falls to 1 / sqrt(5) and 1 / sqrt(3)."""
    y, x = np.mgrid[0:96, 0:96]
    edge = 0.5 + 0.3 * np.tanh((x - 48 - slope * (y - 48)) / 1.5)
    draw = 0.004 * np.random.Generator(np.random.PCG64(6)).standard_normal(edge.shape)
    clean, dirty = (np.repeat(each[..., None], 3, axis=2).astype(np.float32) for each in (edge, edge + draw))
    inner = (slice(4, -4), slice(4, -4))
    on_edge = (np.abs(edge - 0.5) < 0.25)[inner]
    smooth, noisy_one = denoised(clean, 0.02, 0.0)[inner], denoised(dirty, 0.02, 0.0)[inner]
    assert np.abs(smooth - clean[inner]).max() < 0.01
    assert (noisy_one - smooth)[on_edge, 1].std() < 0.65 * draw[inner][on_edge].std()


def test_the_blur_of_colours_leaves_grey_as_it_is_and_takes_the_colour_from_noise():
    """A Gaussian of standard deviation s leaves 1 / (4 pi s^2) of the variance of independent noise."""
    image = noisy(0.05)
    out = denoised(image, 0.0, 3.0)
    assert out @ LUMA == pytest.approx(image @ LUMA, abs=1e-5)
    red, red_before = ((each[..., 0] - each @ LUMA) for each in (out, image))
    assert red.var() / red_before.var() == pytest.approx(1 / (4 * np.pi * 9.0), rel=0.15)


def test_without_the_settings_nothing_changes_and_with_them_noise_falls():
    light = np.full((96, 128, 3), 0.18, np.float32)

    def spread(**changes):
        look = CameraLook(vignetting=0, shot_noise=0.05, **changes)
        return develop(light, CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, 92), 0.18, 1).std()

    assert spread(noise_reduction=0.0, colour_blur_px=0.0) == spread()
    assert spread(noise_reduction=0.1, colour_blur_px=2.0) < 0.5 * spread()
