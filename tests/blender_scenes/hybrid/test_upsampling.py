"""Light of fewer pixels brought to an image's own, on surfaces that are known."""

import numpy as np
import pytest

from blender_scenes.hybrid.upsampling import reduced, upsampled

HEIGHT, WIDTH = 12, 16
TIMES = pytest.mark.parametrize("times", [2, 4])
UP, SIDE = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)


def _plane(nearness: float = 1.0, normal: tuple[float, float, float] = UP) -> tuple[np.ndarray, np.ndarray]:
    """Nearness (H, W, 1) [1/m] and normal (H, W, 3) of a full image."""
    far = np.full((HEIGHT, WIDTH, 1), nearness, np.float32)
    return far, np.broadcast_to(np.array(normal, np.float32), (HEIGHT, WIDTH, 3)).copy()


def _low(values: np.ndarray | float | tuple[float, float, float], times: int = 2) -> np.ndarray:
    """(H / times, W / times, 3)."""
    return np.broadcast_to(np.float32(values), (HEIGHT // times, WIDTH // times, 3)).copy()


@TIMES
def test_fewer_pixels_are_the_means_of_squares(times):
    image = np.random.default_rng(1).random((HEIGHT, WIDTH, 5)).astype(np.float32)
    found = reduced(image, times)
    assert found.shape == (HEIGHT // times, WIDTH // times, 5)
    square = image[2 * times : 3 * times, times : 2 * times].reshape(times**2, 5)
    np.testing.assert_allclose(found[2, 1], square.mean(axis=0), rtol=1e-6)
    assert found.mean() == pytest.approx(image.mean(), rel=1e-5)


def test_light_of_as_many_pixels_is_left_alone():
    low = np.random.default_rng(6).random((HEIGHT, WIDTH, 3)).astype(np.float32)
    np.testing.assert_array_equal(upsampled(low, *_plane()), low)


def test_even_light_stays_even_whatever_it_falls_on():
    rng = np.random.default_rng(2)
    nearness = rng.uniform(0.1, 5.0, (HEIGHT, WIDTH, 1)).astype(np.float32)
    normal = rng.normal(size=(HEIGHT, WIDTH, 3)).astype(np.float32)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    found = upsampled(_low((0.2, 1.0, 7.0)), nearness, normal)
    np.testing.assert_allclose(found, np.broadcast_to((0.2, 1.0, 7.0), found.shape), rtol=1e-5)


@TIMES
@pytest.mark.parametrize("axis", [0, 1])
def test_on_a_plane_light_that_grows_evenly_still_does(axis, times):
    """Pixel p of the image has its middle at (p + 0.5) / times - 0.5 of the smaller one's."""
    low = _low(0.0, times) + np.indices((HEIGHT // times, WIDTH // times))[axis][..., None]
    found = upsampled(low, *_plane())
    expected = (np.indices((HEIGHT, WIDTH))[axis][..., None] + 0.5) / times - 0.5
    inside = slice(times // 2, -(times // 2))
    expected = np.broadcast_to(expected, found.shape)[inside, inside]
    np.testing.assert_allclose(found[inside, inside], expected, atol=1e-5)


@pytest.mark.parametrize("column", [6, 7, 8, 9])
@pytest.mark.parametrize("kind", ["depth", "normal"])
def test_at_an_edge_no_light_passes_from_one_side_to_the_other(column, kind):
    """Also where the edge runs through the squares of four, whose light is then half of one and half of the other's."""
    nearness, normal = _plane()
    if kind == "depth":
        nearness[:, column:] = 0.4
    else:
        normal[:, column:] = SIDE
    bright = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    bright[:, column:] = 1.0
    found = upsampled(reduced(bright, 2), nearness, normal)
    # Where the edge halves a square of four, its own two pixels have nothing but the mix and their next neighbours.
    beside = (column - 1, column) if column % 2 else ()
    dark = [c for c in range(column) if c not in beside]
    lit = [c for c in range(column, WIDTH) if c not in beside]
    assert np.abs(found[:, dark]).max() < 0.02
    assert np.abs(found[:, lit] - 1).max() < 0.02
    for own, truth in zip(beside, (0.0, 1.0), strict=False):
        assert np.abs(found[:, own] - truth).max() < 0.5


def test_a_pixel_without_a_like_neighbour_takes_a_mix_of_them_all():
    nearness, normal = _plane()
    nearness[5, 7], normal[5, 7] = 50.0, SIDE
    low = np.random.default_rng(3).uniform(1.0, 2.0, (HEIGHT // 2, WIDTH // 2, 3)).astype(np.float32)
    found = upsampled(low, nearness, normal)
    assert np.isfinite(found).all()
    around = low[2:4, 3:5]
    assert (around.min(axis=(0, 1)) <= found[5, 7]).all()
    assert (found[5, 7] <= around.max(axis=(0, 1))).all()


def test_where_the_camera_sees_nothing_light_is_finite():
    """No normal, and no nearness."""
    nearness, normal = _plane()
    nearness[:5], normal[:5] = 0.0, 0.0
    found = upsampled(_low(2.0), nearness, normal)
    np.testing.assert_allclose(found, 2.0, rtol=1e-5)
