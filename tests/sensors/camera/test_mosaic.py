"""The Bayer filter: what its interpolation keeps, and the noise behind it, by the sums of its coefficients."""

import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook
from sensors.camera.mosaic import colours, demosaiced, mosaic
from sensors.camera.response import CameraResponse, develop, develop_part, inverse_tone

SIZE = 256


@pytest.fixture(scope="module")
def noise():
    """Colours (H, W, 3) interpolated from independent noise of variance 1."""
    return demosaiced(np.random.Generator(np.random.PCG64(7)).standard_normal((SIZE, SIZE)).astype(np.float32))


def test_each_block_has_a_red_two_green_and_a_blue_pixel():
    assert colours(4, 4).tolist() == [[0, 1, 0, 1], [1, 2, 1, 2]] * 2
    light = np.arange(12, dtype=np.float32).reshape(2, 2, 3)
    assert mosaic(light).tolist() == [[0.0, 4.0], [7.0, 11.0]]


@pytest.mark.parametrize(("height", "width"), [(24, 32), (25, 31)])
def test_an_even_colour_stays_and_measured_values_stay(height, width):
    even = np.broadcast_to(np.array([0.6, 0.4, 0.1], np.float32), (height, width, 3))
    grey = np.repeat(np.random.default_rng(3).uniform(size=(height, width, 1)).astype(np.float32), 3, axis=2)
    # Grey has no colour differences, but the interpolation of one colour from the others is exact only if it is even.
    assert demosaiced(mosaic(even)) == pytest.approx(even, abs=1e-6)
    at = colours(height, width)[..., None]
    assert np.array_equal(np.take_along_axis(demosaiced(mosaic(grey)), at, 2), np.take_along_axis(grey, at, 2))


def test_a_grey_ramp_stays_exact():
    x, y = np.meshgrid(np.arange(20.0), np.arange(16.0))
    ramp = np.repeat((0.02 * x + 0.03 * y)[..., None], 3, axis=2).astype(np.float32)
    assert demosaiced(mosaic(ramp))[2:-2, 2:-2] == pytest.approx(ramp[2:-2, 2:-2], abs=1e-5)


def test_the_variance_of_interpolated_noise_is_the_sum_of_squared_coefficients(noise):
    """Green at red: (16 + 4 x 4 + 4 x 1) / 64. Red at green: (25 + 2 x 16 + 6 x 1 + 2 / 4) / 64.

    Red at blue: (36 + 4 x 4 + 4 x 9 / 4) / 64.
    """
    variance = {(row, column): noise[row::2, column::2].var(axis=(0, 1)) for row in (0, 1) for column in (0, 1)}
    assert variance[0, 0] == pytest.approx([1.0, 36 / 64, 61 / 64], rel=0.05)
    assert variance[0, 1] == pytest.approx([63.5 / 64, 1.0, 63.5 / 64], rel=0.05)
    assert variance[1, 1] == pytest.approx([61 / 64, 36 / 64, 1.0], rel=0.05)


def test_interpolated_noise_is_shared_by_colours_and_neighbours(noise):
    """At a green pixel red has 5/8 of it. Green at a red pixel has 2/8 of each green neighbour."""
    green_pixel, red_pixel = noise[0::2, 1::2], noise[0::2, 0::2]
    assert np.mean(green_pixel[..., 0] * green_pixel[..., 1]) == pytest.approx(5 / 8, abs=0.03)
    assert np.mean(red_pixel[..., 1] * green_pixel[..., 1]) == pytest.approx(2 / 8, abs=0.03)


def test_a_sensor_with_a_filter_has_the_noise_of_one_colour_per_pixel():
    """Green is measured in the odd columns of even rows; sRGB's slope there turns light into grey values."""
    look = CameraLook(
        contrast=1, saturation=1, vignetting=0, shot_noise=0, read_noise=0.02, white_balance_adaption=1,
        brightness=0.18, colour_filter="bayer",
    )  # fmt: skip
    response = CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, 92)
    grey = np.full((SIZE, SIZE, 3), 0.18, np.float32)
    image = develop(grey, response, 0.18, 1)
    assert np.array_equal(image, develop(grey, response, 0.18, 1))
    linear = ((image / 255 + 0.055) / 1.055) ** 2.4
    assert linear[0::2, 1::2, 1].std() == pytest.approx(0.02, rel=0.03)
    assert linear[0::2, 0::2, 1].std() == pytest.approx(0.75 * 0.02, rel=0.03)


def test_behind_a_filter_noise_makes_no_pixel_of_the_sensor_darker_than_black():
    """Without its negative half, noise has a mean of sd / sqrt(2 pi), which the interpolation keeps.

    What it makes darker than black is then cut off too, which can only raise the mean.
    """
    look = CameraLook(
        contrast=1, saturation=1, vignetting=0, shot_noise=0, read_noise=0.05, white_balance_adaption=1,
        colour_filter="bayer",
    )  # fmt: skip
    response = CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, 92)
    coded = develop_part(np.zeros((SIZE, SIZE, 3), np.float32), response, 1.0, 1)
    green_at_red = inverse_tone(coded[0::2, 0::2, 1].astype(np.float64) / 255, 1.0)
    assert green_at_red.mean() > 0.98 * 0.05 / np.sqrt(2 * np.pi)


GREY = 0.5
EXPOSED = CameraLook(
    contrast=1, saturation=1, vignetting=0, shot_noise=0, read_noise=0, white_balance_adaption=1, brightness=GREY,
    exposure_adaption=0, colour_filter="bayer",
)  # fmt: skip


def _lamp(row: int, column: int, size: int, look: CameraLook = EXPOSED) -> np.ndarray:
    """Return the image of a lamp of 100 times the light of white in the middle of grey."""
    light = np.full((64, 64, 3), GREY, np.float32)
    light[row : row + size, column : column + size] = 100
    return develop(light, CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, 92), GREY, 1)


@pytest.mark.parametrize(
    ("row", "column", "eighths"), [(30, 30, -1.5), (30, 31, -1.0), (31, 31, -1.5)], ids=["red", "green", "blue"]
)
def test_beside_a_lamp_pixels_are_as_dark_as_beside_a_step_to_white_and_no_darker(row, column, eighths):
    """A pixel of each colour has this smallest weight for its neighbours; white is what becomes 254.5 of 255."""
    linear_white = ((254.5 / 255 + 0.055) / 1.055) ** 2.4
    white = 0.6 - 0.4 * np.log((1 - linear_white) / 0.4)  # the shoulder of the tone curve, solved for the light
    darkest = GREY + eighths / 8 * (white - GREY)
    image = _lamp(row, column, 1)
    assert image.min() == pytest.approx(255 * (1.055 * darkest ** (1 / 2.4) - 0.055), abs=6)
    assert image[row, column].max() == 255


def test_a_colour_that_the_interpolation_makes_darker_than_black_is_black():
    """Beside a red pixel of 8 times its light, a red pixel has -1/16 of that light in green and -6/64 in blue."""
    light = np.zeros((16, 16, 3), np.float32)
    light[8, 6, 0], light[8, 8, 0] = 0.4, 0.05
    look = EXPOSED.model_copy(update={"saturation": 0.0})
    image = develop_part(light, CameraResponse.from_look(look, (1.0, 1.0, 1.0), 1, 92), GREY, None)
    grey = 255 * (1.055 * (0.2126 * 0.05) ** (1 / 2.4) - 0.055)  # red alone, by Rec. 709 and the curve of sRGB
    assert image[8, 8] == pytest.approx([grey, grey, grey], rel=1e-3)


@pytest.mark.parametrize("kelvin", [2500.0, 5000.0, 12000.0])
def test_a_lamp_is_white_under_any_white_balance(kelvin):
    look = EXPOSED.model_copy(update={"white_balance_adaption": 0.0, "white_balance_K": kelvin})
    image = _lamp(24, 24, 12, look)
    assert np.all(image[26:34, 26:34] == 255)
