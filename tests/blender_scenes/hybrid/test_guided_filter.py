"""Lines by which values follow a guide: exact where they do, flat where there is nothing to follow."""

import numpy as np
import pytest

from blender_scenes.hybrid.guided_filter import carried_from_around, local_lines, no_brighter_than_around

HEIGHT, WIDTH = 24, 32
EVERYWHERE = np.ones((HEIGHT, WIDTH, 1), np.float32)


def _followed(lines: np.ndarray, own: np.ndarray, guide: np.ndarray | np.float32) -> np.ndarray:
    """The values of a guide by the lines found with their own."""
    slope, value = np.split(lines, 2, axis=-1)
    return value + slope * (guide - own)


def _two_kinds() -> np.ndarray:
    """(H, W, 1) guide: stripes of 0.3 and 0.9."""
    stripes = np.where(np.arange(WIDTH) // 4 % 2, 0.3, 0.9).astype(np.float32)
    return np.broadcast_to(stripes[None, :, None], (HEIGHT, WIDTH, 1)).copy()


def test_values_on_a_line_over_the_guide_are_exact():
    """To what the least variance takes off the slope: 1e-4 of a variance of up to 0.09."""
    guide = _two_kinds()
    values = guide * np.float32([2.0, -0.5]) + np.float32([0.1, 0.8])
    np.testing.assert_allclose(_followed(local_lines(values, guide, EVERYWHERE), guide, guide), values, atol=0.01)


def test_a_finer_guide_brings_back_the_edge_that_coarse_pixels_do_not_have():
    """Pixels of four, each the mean of two kinds in shares of its own, tell what each kind alone is."""
    rng = np.random.default_rng(1)
    fine = np.where(rng.random((HEIGHT, WIDTH, 4)) < rng.random((HEIGHT, WIDTH, 1)), 0.3, 0.9).astype(np.float32)
    of_kind = np.where(fine < 0.5, 5.0, 1.0)
    coarse, values = (a.mean(axis=-1, keepdims=True).astype(np.float32) for a in (fine, of_kind))
    lines = local_lines(values, coarse, EVERYWHERE)
    for own, value in ((0.3, 5.0), (0.9, 1.0)):
        assert _followed(lines, coarse, np.float32(own)) == pytest.approx(np.full((HEIGHT, WIDTH, 1), value), abs=0.05)


def test_under_an_even_guide_values_are_their_mean_around():
    rng = np.random.default_rng(2)
    values = rng.normal(1.0, 0.1, (HEIGHT, WIDTH, 1)).astype(np.float32)
    guide = np.full_like(values, 0.7)
    found = _followed(local_lines(values, guide, EVERYWHERE), guide, guide)
    assert found.std() < 0.3 * values.std()
    assert found.mean() == pytest.approx(values.mean(), abs=0.01)


def test_what_counts_for_nothing_has_no_say():
    guide, weight = _two_kinds(), EVERYWHERE.copy()
    values = 3 * guide
    values[8:16, 8:16], weight[8:16, 8:16] = 1000.0, 0.0
    found = _followed(local_lines(values, guide, weight), guide, guide)
    assert found[weight > 0] == pytest.approx((3 * guide)[weight > 0], abs=0.05)


def test_where_nothing_around_counts_a_value_is_its_own():
    values = np.random.default_rng(3).random((HEIGHT, WIDTH, 2)).astype(np.float32)
    lines = local_lines(values, _two_kinds(), 0 * EVERYWHERE)
    np.testing.assert_array_equal(lines, np.concatenate([0 * values, values], axis=-1))


# 1 where light is that of the floor alone; from column 16 on, pixels show something else as well.
BESIDE = (np.arange(WIDTH) < 16).astype(np.float32)[None, :, None] * EVERYWHERE


def test_a_bright_face_does_not_brighten_the_floor_beside_it():
    floor = np.float32([2.0, 0.5])
    light = np.where(BESIDE > 0, floor, 3 * floor)
    found = no_brighter_than_around(light, BESIDE)
    np.testing.assert_allclose(found[:, :18], np.broadcast_to(floor, (HEIGHT, 18, 2)), rtol=1e-5)
    np.testing.assert_array_equal(found[:, 20:], light[:, 20:])


def test_a_shadow_at_a_foot_stays_as_dark_as_it_is():
    light = np.where(BESIDE > 0, 2.0, 0.7).astype(np.float32)
    np.testing.assert_array_equal(no_brighter_than_around(light, BESIDE), light)


def test_light_where_all_is_floor_is_unchanged():
    light = np.random.default_rng(4).random((HEIGHT, WIDTH, 3)).astype(np.float32)
    np.testing.assert_array_equal(no_brighter_than_around(light, EVERYWHERE), light)


def test_light_is_carried_over_an_edge_of_three_pixels_and_no_further():
    """Left of the edge, light is known; right of it there is other light, and a mixture in between."""
    light = np.ones((HEIGHT, WIDTH, 3), np.float32)
    light[:, 16:19], light[:, 19:] = 3.0, 5.0
    known = (np.arange(WIDTH) < 16).astype(np.float32)[None, :, None] * EVERYWHERE
    carried = carried_from_around(light, known)
    np.testing.assert_array_equal(carried[:, :16], light[:, :16])
    np.testing.assert_allclose(carried[:, 16:19], 1.0, rtol=1e-5)
    np.testing.assert_array_equal(carried[:, 22:], light[:, 22:])
