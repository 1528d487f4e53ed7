"""Light on the floor beside bodies: without noise, and with the holes below them filled."""

import numpy as np
import pytest

from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.hybrid.floor.footprints import Footprints
from blender_scenes.hybrid.floor.light import nearest_free, without_holes, without_noise
from blender_scenes.hybrid.floor.tiled_map import Tile
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import stood


def _lit(side: int = 24) -> np.ndarray:
    rng = np.random.default_rng(5)
    return (1 + 0.2 * rng.random((side, side, 3))).astype(np.float32)


@pytest.mark.parametrize(
    "hole", [(slice(5, 12), slice(8, 20)), (slice(0, 9), slice(0, 24)), (slice(20, 24), slice(20, 24))]
)
def test_a_hole_takes_its_light_from_around_it_and_all_else_keeps_its_own(hole):
    light, free = _lit(), np.ones((24, 24, 1), np.float32)
    light[hole] = free[hole] = 0
    filled = without_holes(light, free, nearest_free(free))
    kept = free[..., 0] > 0
    np.testing.assert_array_equal(filled[kept], light[kept])
    around = {tuple(texel) for texel in light[kept].tolist()}
    assert {tuple(texel) for texel in filled[hole].reshape(-1, 3).tolist()} <= around


@pytest.mark.parametrize("share", [0.0, 0.2, 0.45, 0.6, 1.0])
def test_both_sides_of_a_wall_have_their_own_light_up_to_its_middle(share):
    """A wall from column 10 to 13, which covers a share of its outer columns; bright behind it, in the shade before."""
    free = np.ones((16, 24, 1), np.float32)
    free[:, 11:13], free[:, [10, 13]] = 0.0, 1 - share
    true = np.where(np.arange(24) < 12, 1.0, 5.0)[:, None] * np.array([1.0, 0.8, 0.6])
    row = without_holes((true * free).astype(np.float32), free, nearest_free(free))[8]
    np.testing.assert_allclose(row, true, rtol=1e-6)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_where_all_or_nothing_is_free_nothing_changes(share):
    light = share * _lit()
    free = np.full((24, 24, 1), share, np.float32)
    np.testing.assert_array_equal(without_holes(light, free, nearest_free(free)), light)


SIDE, TEXEL_M = 96, 0.004
SAMPLES, LIT_SHARE = 8, 0.3
"""Paths of a texel, and the share of them that meets a lamp."""
BEFORE, BEHIND = np.array([1.0, 0.9, 0.8]), np.array([4.0, 3.9, 3.6])


@pytest.mark.parametrize("thick_m", [0.01, 0.05])
def test_light_with_noise_is_right_on_both_sides_of_a_wall_up_to_its_feet(thick_m):
    """A wall, which stands askew, between shade and light: each texel has the mean of a few paths."""
    wall = stood(block("wall", (0.0, 0.0, 0.1), (2.0, thick_m, 0.2), "any"), (0.19, 0.19, 1.45))
    free = 1 - Footprints([wall]).covered(Tile((0.0, 0.0), TEXEL_M, SIDE, (0, 0, 0)))
    y, x = (np.indices((SIDE, SIDE)) + 0.5) * TEXEL_M - 0.19
    left = (x - y / np.tan(1.45) < 0)[..., None]
    true = np.where(left, BEFORE, BEHIND)
    random = np.random.default_rng(3)
    paths = random.random((SIDE, SIDE, SAMPLES)) < free
    meet = paths & (random.random((SIDE, SIDE, SAMPLES)) < LIT_SHARE)
    light = (true * meet.mean(axis=-1, keepdims=True) / LIT_SHARE).astype(np.float32)
    even = without_noise(light, free, Denoiser(1, "HIGH"), keeps_mean=True)
    # The texels that are wholly or partly beside the wall, less than three texels away from it.
    away_m = np.abs(x * np.sin(1.45) - y * np.cos(1.45)) - 0.5 * thick_m
    foot = (away_m > -0.5 * TEXEL_M) & (away_m < 3 * TEXEL_M)
    inner = np.s_[8:-8, 8:-8]
    off = (even / true - 1)[inner]
    for side in (left, ~left):
        near = (foot & side[..., 0])[inner]
        assert near.sum() > 200
        # The paths of these texels alone have a mean with a standard error of 0.03.
        assert np.sqrt((off[near] ** 2).mean()) < 0.06


def test_light_keeps_the_mean_of_its_samples_where_few_paths_bring_it():
    """One path of fifty meets the lamp. With the denoiser alone, 2.5 % of the light are missing."""
    side, share = 256, 0.02
    random = np.random.default_rng(1)
    meet = random.random((side, side, SAMPLES)) < share
    light = np.repeat((meet.mean(axis=-1, keepdims=True) / share).astype(np.float32), 3, axis=-1)
    even = without_noise(light, np.ones((side, side, 1), np.float32), Denoiser(1, "HIGH"), keeps_mean=True)
    assert even.mean() == pytest.approx(light.mean(), rel=0.01)
    assert even.std() < 0.2 * light.std()


def test_light_keeps_its_mean_beside_bodies_that_are_left_out():
    """A wide body stands on half of the floor, where no light is counted."""
    side, share = 256, 0.02
    free = np.ones((side, side, 1), np.float32)
    free[:, side // 2 :] = 0
    meet = np.random.default_rng(2).random((side, side, SAMPLES)) < share
    light = np.repeat((free * meet.mean(axis=-1, keepdims=True) / share).astype(np.float32), 3, axis=-1)
    even = without_noise(light, free, Denoiser(1, "HIGH"), keeps_mean=True)
    assert even[:, : side // 2].mean() == pytest.approx(light[:, : side // 2].mean(), rel=0.015)
