"""The share of the light that what moves leaves, against closed form: a lamp that is hidden from a part of a floor."""

import numpy as np
import pytest

from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.hybrid.shadows.moving_shade import denoised_pair

HEIGHT, WIDTH, SAMPLES = 60, 80, 4
LAMPS = np.array([1.0, 1.0, 2.0, 4.0])
"""Light of the lamps, one of which each path chooses by chance."""
MEETS = 0.6
"""Share of the paths that no furniture ends."""
COLOR = np.array([1.0, 0.9, 0.8], np.float32)


def _hidden() -> np.ndarray:
    """Return the share (H, W) of the last lamp, the half of all light, that is hidden: a shadow with a wide border."""
    x, y = (np.arange(WIDTH) + 0.5) / WIDTH, (np.arange(HEIGHT)[:, None] + 0.5) / HEIGHT
    return np.clip(4 * (y - 0.35), 0, 1) * np.clip(8 * (0.3 - np.abs(x - 0.5)), 0, 1)


def _paths(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the light (H, W, S) of each path with and without what hides the lamp."""
    random = np.random.default_rng(seed)
    shape = HEIGHT, WIDTH, SAMPLES
    lamp, meets = random.integers(len(LAMPS), size=shape), random.random(shape) < MEETS
    still = meets * LAMPS[lamp]
    return still * ~((lamp == len(LAMPS) - 1) & (random.random(shape) < _hidden()[..., None])), still


def _pixels(paths: np.ndarray) -> np.ndarray:
    return (paths.mean(axis=-1)[..., None] * COLOR).astype(np.float32)


LIT = np.ones((HEIGHT, WIDTH, 3), np.float32)
"""Prediction far from all that moves."""
UP = np.broadcast_to(np.array((0.0, 0.0, 1.0), np.float32), (HEIGHT, WIDTH, 3))


@pytest.fixture(scope="module")
def off() -> np.ndarray:
    """Error (3, H, W) of the share of the light that is left, for other random numbers each."""
    denoised, true = Denoiser(1, "HIGH"), 1 - 0.5 * _hidden()
    drawn = (_paths(seed) for seed in (1, 2, 3))
    pairs = (denoised_pair(_pixels(moved), _pixels(still), UP, denoised, LIT) for moved, still in drawn)
    return np.stack([(moved / still).mean(axis=-1) - true for moved, still in pairs])


def test_beside_a_shadow_the_share_has_no_noise_of_the_light_there(off):
    """A ratio of two denoised images is off by 0.024 there (root mean square)."""
    assert np.sqrt((off[:, _hidden() == 0] ** 2).mean()) < 0.005


def test_the_shadow_has_the_light_of_the_other_lamps(off):
    shade = _hidden() > 0.8
    assert off[:, shade].mean() == pytest.approx(0.0, abs=0.02)
    assert np.sqrt((off[:, shade] ** 2).mean()) < 0.04


def test_where_nothing_that_moves_matters_both_lights_are_equal():
    still = _pixels(_paths(1)[1])
    moved, without = denoised_pair(still, still, UP, Denoiser(1, "HIGH"), LIT)
    np.testing.assert_array_equal(moved, without)


def test_a_thing_that_moves_may_throw_light():
    """All of the floor has a quarter more light from it."""
    still = np.full((HEIGHT, WIDTH, 3), 0.4, np.float32)
    moved, without = denoised_pair(1.25 * still, still, UP, Denoiser(1, "HIGH"), LIT)
    assert (moved / without)[8:-8, 8:-8] == pytest.approx(1.25, rel=0.02)


SHADE = np.where((np.arange(HEIGHT)[:, None] > 30) & (np.abs(np.arange(WIDTH) - 40) < 20), 0.1, 1.0)
"""Share (H, W) of the light that is left in a shadow whose border lies between two pixels."""


@pytest.mark.parametrize("predicted", [0.1, 0.3], ids=["right", "too bright"])
def test_the_border_of_a_shadow_is_as_sharp_as_it_is_predicted(predicted):
    """Without it, the last pixel before the border has 0.95 of the light, and the first one behind it 0.21."""
    denoised, random = Denoiser(1, "HIGH"), np.random.default_rng(7)
    still = _paths(5)[1]
    hits = random.random(still.shape) < SHADE[..., None]
    guide = np.repeat(np.where(SHADE < 1, predicted, 1.0)[..., None], 3, axis=-1).astype(np.float32)
    moved, without = denoised_pair(_pixels(still * hits), _pixels(still), UP, denoised, guide)
    ratio = (moved / without).mean(axis=-1)
    rows = slice(29, 33)
    assert ratio[rows, 26:54].mean(axis=1) == pytest.approx(SHADE[rows, 40], abs=0.04)
