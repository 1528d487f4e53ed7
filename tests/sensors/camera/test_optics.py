"""The transfer of lens, focus and pixel area, compared with their closed forms."""

import numpy as np
import pytest
from scipy.special import j1

from configs.schema.appearance.camera_look import CameraLook
from sensors.camera.optics import blurred, box, defocused, disc, integrated_over_pixel
from sensors.camera.response import CameraResponse, develop

PLAIN = CameraLook(
    contrast=1, saturation=1, vignetting=0, shot_noise=0, read_noise=0, brightness=0.18, white_balance_adaption=1
)


def transfer(through, frequency):
    """Return the modulation of a wave along a row, of this many cycles a pixel, behind a stage over that before."""
    x = np.arange(257)
    wave = 1.0 + 0.5 * np.cos(2 * np.pi * frequency * (x - 128))
    light = np.repeat(np.repeat(wave[None, :, None], 64, axis=0), 3, axis=2).astype(np.float32)
    return float((through(light)[32, 128, 1] - 1.0) / 0.5)


@pytest.mark.parametrize("frequency", [0.05, 0.1, 0.2])
def test_a_gaussian_point_spread_has_a_gaussian_transfer(frequency):
    expected = np.exp(-2 * (np.pi * frequency * 1.3) ** 2)
    assert transfer(lambda light: blurred(light, 1.3), frequency) == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("frequency", [0.05, 0.1, 0.2])
def test_a_blur_disc_has_the_transfer_of_its_bessel_function(frequency):
    """2 J1(pi f d) / (pi f d) for the disc, and sinc(f) for the area of a pixel (Goodman, Fourier Optics, 6.4.4)."""
    argument = np.pi * frequency * 4.0
    expected = 2 * j1(argument) / argument * np.sinc(frequency)
    assert transfer(lambda light: defocused(light, 4.0), frequency) == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("frequency", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("width", [1.0, 3.0, 5.0])
def test_an_odd_number_of_pixels_has_the_transfer_of_their_mean(width, frequency):
    """sin(pi f w) / (w sin(pi f)) for the mean of w samples."""
    expected = np.sin(np.pi * frequency * width) / (width * np.sin(np.pi * frequency))
    assert transfer(lambda light: integrated_over_pixel(light, width), frequency) == pytest.approx(expected, abs=1e-4)


def test_a_square_of_two_pixels_takes_half_of_each_neighbour_and_every_kernel_keeps_the_light():
    assert box(2.0).tolist() == [0.25, 0.5, 0.25]
    assert box(1.0).tolist() == [1.0]
    for kernel in (box(2.7), disc(0.6), disc(3.3)):
        assert kernel.sum() == pytest.approx(1.0, abs=1e-6)
        assert np.array_equal(kernel, kernel[::-1])


def test_a_disc_within_a_pixel_changes_nothing():
    assert disc(1.0).tolist() == [[1.0]]


def test_an_edge_out_of_focus_is_as_wide_as_its_disc():
    """The 10 to 90 % width of an edge behind an even disc is 0.687 of the diameter; a pixel adds its own area."""
    light = np.where(np.arange(81) < 40, 0.1, 1.0)[None, :, None] * np.ones((41, 1, 3))
    edge = (defocused(light.astype(np.float32), 12.0)[20, :, 1] - 0.1) / 0.9
    at = np.interp([0.1, 0.9], edge, np.arange(81))
    assert at[1] - at[0] == pytest.approx(0.687 * 12.0, rel=0.02)


@pytest.mark.parametrize("diameter_px", [1e-6, 0.03, 0.07, 0.5, 1.0])
def test_a_disc_within_one_pixel_changes_nothing(diameter_px):
    light = np.random.default_rng(1).random((6, 8, 3)).astype(np.float32)
    assert np.array_equal(defocused(light, diameter_px), light)


def test_a_disc_a_little_larger_than_a_pixel_keeps_the_light():
    assert disc(1.001).sum() == pytest.approx(1.0)


def test_the_settings_reach_the_image():
    light = np.random.default_rng(2).uniform(0.05, 0.4, (48, 64, 3)).astype(np.float32)
    plain = develop(light, CameraResponse.from_look(PLAIN, (1.0, 1.0, 1.0), 1, 92), 0.2, 1).astype(float)
    for changes in ({"defocus_share": 3 / 64}, {"pixel_px": 3.0}):
        look = PLAIN.model_copy(update=changes)
        soft = develop(light, CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, 92, 64), 0.2, 1).astype(float)
        assert soft.std() < 0.5 * plain.std()


@pytest.mark.parametrize("colour_filter", ["none", "bayer"])
def test_black_beside_a_lamp_out_of_focus_has_no_shot_noise(colour_filter):
    """OpenCV computes so wide a blur by a Fourier transform, which leaves values just below 0."""
    light = np.zeros((64, 64, 3), np.float32)
    light[:8, :8] = 1000.0
    assert defocused(light, 12.0).min() < 0.0
    look = PLAIN.model_copy(
        update={"shot_noise": 0.1, "defocus_share": 12 / 64, "exposure_adaption": 0.0, "colour_filter": colour_filter}
    )
    response = CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, jpeg_quality=92, width_px=64)
    assert develop(light, response, 1.0, 1)[20:, 20:].max() == 0
