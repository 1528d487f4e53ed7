"""The light that a denoiser removes, in images whose mean is known."""

import numpy as np
import pytest

from blender_scenes.render.lost_light import lost_light_factor

SHAPE = 60, 80, 3
EVEN = np.full(SHAPE, 2.0, np.float32)


def _rare_bright_pixels(random: np.random.Generator, share: float, light: float) -> np.ndarray:
    """Return an image of mean 2: `light` of it is spread evenly, the rest is in a share of the pixels."""
    bright = (random.random((*SHAPE[:2], 1)) < share) / share
    return np.repeat(2.0 * (light + (1 - light) * bright), 3, axis=-1).astype(np.float32)


def test_an_image_that_lost_the_light_of_many_bright_pixels_gets_it_back():
    """One pixel of 50 has 5 % of the light; an image of 4800 pixels shows that to 0.5 % of the light."""
    random = np.random.Generator(np.random.PCG64(1))
    factors = [lost_light_factor(_rare_bright_pixels(random, 0.02, 0.95), 0.95 * EVEN) for _ in range(100)]
    # The weight of the difference is 1 - (0.5 / 5)^2 on average.
    assert 0.95 * np.mean(factors) == pytest.approx(1 - 0.05 * 0.1**2, abs=4 * 0.005 / 100**0.5)


@pytest.mark.parametrize("light", [5000.0, 1e9, np.nan, np.inf])
def test_a_single_bright_pixel_changes_nothing(light):
    noisy = EVEN.copy()
    noisy[10, 20] = light
    assert lost_light_factor(noisy, EVEN) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("sd", [0.1, 1.0])
def test_even_noise_changes_less_than_its_standard_error(sd):
    random = np.random.Generator(np.random.PCG64(2))
    noise = [random.normal(0.0, sd, (*SHAPE[:2], 1)).astype(np.float32) for _ in range(200)]
    factors = np.array([lost_light_factor(EVEN + each, EVEN) for each in noise])
    standard_error = sd / 2.0 / 4800**0.5
    assert np.mean(factors == 1.0) == pytest.approx(0.683, abs=4 * (0.683 * 0.317 / 200) ** 0.5)
    assert factors.mean() == pytest.approx(1.0, abs=4 * standard_error / 200**0.5)
    assert factors.std() < standard_error


def test_a_denoised_image_that_is_too_bright_gets_darker():
    assert lost_light_factor(EVEN, 1.25 * EVEN) == pytest.approx(0.8)


@pytest.mark.parametrize("light", [0.0, 2.0])
def test_an_image_without_noise_stays_as_it_is(light):
    image = np.full(SHAPE, light, np.float32)
    assert lost_light_factor(image, image) == 1.0


def test_a_single_pixel_keeps_its_light():
    assert lost_light_factor(np.ones((1, 3), np.float32), np.full((1, 3), 0.5, np.float32)) == 1.0
