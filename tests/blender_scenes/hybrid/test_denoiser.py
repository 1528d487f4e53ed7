"""Noise is taken off light, whatever was denoised before."""

import numpy as np
import pytest

from blender_scenes.hybrid.denoiser import Denoiser


def noisy(height_px: int, width_px: int, seed: int) -> np.ndarray:
    """(H, W, 3) of mean 1 and standard deviation 1."""
    return np.random.Generator(np.random.PCG64(seed)).exponential(1.0, (height_px, width_px, 3)).astype(np.float32)


def upwards(like: np.ndarray) -> np.ndarray:
    return np.broadcast_to(np.array((0.0, 0.0, 1.0), np.float32), like.shape)


@pytest.mark.parametrize(("quality", "off"), [("BALANCED", 0.05), ("HIGH", 0.03)])
def test_noise_about_a_constant_is_evened_out_and_its_mean_kept_as_well_as_the_network_can(quality, off):
    noise = noisy(64, 64, 1)
    clean = Denoiser(1, quality)(noise, upwards(noise))
    assert clean.mean() == pytest.approx(noise.mean(), rel=off)
    assert clean.std() < 0.1 * noise.std()


def test_an_edge_that_the_guide_shows_stays_where_it_is():
    noise, albedo = noisy(64, 64, 2), np.full((64, 64, 3), 0.2, np.float32)
    albedo[:, 32:] = 0.8
    clean = Denoiser(1, "HIGH")(noise * albedo, upwards(noise), albedo)
    assert clean[8:-8, 30].mean() < 0.3
    assert clean[8:-8, 33].mean() > 0.7


def test_an_image_does_not_depend_on_those_denoised_before_nor_on_threads():
    first, other = noisy(48, 64, 3), noisy(32, 40, 4)
    kept = Denoiser(1, "BALANCED")
    alone = kept(first, upwards(first))
    kept(other, upwards(other))
    kept(first + 1, upwards(first))
    np.testing.assert_array_equal(kept(first, upwards(first)), alone)
    np.testing.assert_array_equal(Denoiser(2, "BALANCED")(first, upwards(first)), alone)


def test_even_light_keeps_its_mean_if_half_of_it_is_in_few_bright_pixels():
    """A path in fifty finds a lamp. The denoiser alone takes a fifth of all light for noise."""
    bright = np.random.Generator(np.random.PCG64(5)).random((256, 256, 1)) < 0.02
    noise = np.repeat((1 + 50 * bright).astype(np.float32), 3, axis=-1)
    denoiser = Denoiser(1, "BALANCED")
    kept = denoiser.keeping_mean(noise, upwards(noise), np.ones_like(noise))
    assert kept.mean() == pytest.approx(noise.mean(), rel=0.02)
    assert kept.std() < 0.1 * noise.std()


def test_the_pixels_with_a_weight_keep_their_mean_whatever_the_others_have():
    """The other half has twice the light in fewer bright pixels."""
    random = np.random.Generator(np.random.PCG64(6))
    bright = random.random((256, 256, 1)) < 0.02
    bright[:, 128:] = random.random((256, 128, 1)) < 0.01
    noise = np.repeat((1 + bright * np.where(np.arange(256) < 128, 50, 300)[:, None]).astype(np.float32), 3, axis=-1)
    weight = np.broadcast_to(0.4 * (np.arange(256) < 128)[:, None], noise.shape).astype(np.float32)
    kept = Denoiser(1, "HIGH").keeping_mean(noise, upwards(noise), weight=weight)
    assert kept[:, 4:124].mean() == pytest.approx(noise[:, :128].mean(), rel=0.03)


def test_without_any_weight_the_denoised_light_is_left_as_it_is():
    noise = np.random.Generator(np.random.PCG64(7)).random((64, 64, 3)).astype(np.float32)
    denoiser = Denoiser(1, "HIGH")
    empty = denoiser.keeping_mean(noise, upwards(noise), weight=np.zeros_like(noise))
    np.testing.assert_array_equal(empty, denoiser(noise, upwards(noise)))
