"""The estimators on images of which the answer is known."""

import cv2
import numpy as np
import pytest

from diagnosis.photographs.image_figures import ImageFigures

LINE, FLOOR = 40.0, 160.0
MIDDLE = 79.5
ROWS = (31.5, 59.5, 87.5)


def figures_of(drawn, x_px):
    return ImageFigures.from_image(drawn, x_px, ROWS)


def image(blur_px, noise=0.0, slant=0.0):
    """A line 40 px wide, upright or slanted, drawn four times as fine and averaged down; then blur, then noise."""
    y, x = np.mgrid[0:480, 0:640] / 4 - 0.375
    off = x - MIDDLE - slant * (y - 59.5)
    fine = np.where(np.abs(off) < 20, LINE, FLOOR).astype(np.float32)
    grey = cv2.resize(fine, (160, 120), interpolation=cv2.INTER_AREA)
    grey = cv2.GaussianBlur(grey, (0, 0), blur_px)
    grey = grey + noise * np.random.Generator(np.random.PCG64(1)).standard_normal(grey.shape)
    return np.repeat(np.clip(np.rint(grey), 0, 255).astype(np.uint8)[..., None], 3, axis=2)


def upright():
    return np.full(3, MIDDLE)


def test_an_edge_is_as_wide_as_its_blur():
    """10 to 90 % of an error function are 2.563 standard deviations; a pixel's width adds 1/12 to the variance."""
    sd = np.hypot(1.5, np.sqrt(1 / 12))
    assert figures_of(image(1.5), upright()).edge_px == pytest.approx(2.563 * sd, rel=0.05)


def test_an_edge_counts_square_to_itself():
    """A line slanted by 30 degrees has the same blur and a longer way through it along the row."""
    slant = np.tan(np.radians(30))
    x_px = MIDDLE + slant * (np.array(ROWS) - 59.5)
    wide = figures_of(image(1.5, slant=slant), x_px).edge_px
    assert wide == pytest.approx(2.563 * np.hypot(1.5, np.sqrt(1 / 12)), rel=0.08)


def test_noise_is_what_was_added():
    """Rounding to whole grey values adds 1/12 to the variance."""
    figure = figures_of(image(1.5, noise=3.0), upright()).noise
    assert figure == pytest.approx(np.hypot(3.0, np.sqrt(1 / 12)), rel=0.05)


def test_contrast_and_range_are_those_drawn():
    image_figures = figures_of(image(1.0), upright())
    assert image_figures.contrast == pytest.approx((FLOOR - LINE) / (FLOOR + LINE), abs=0.01)
    assert (image_figures.black, image_figures.white, image_figures.saturation_percent) == (LINE, FLOOR, 0)


def test_a_light_line_has_the_edge_and_the_contrast_of_its_negative():
    """Negative levels are 215 and 95."""
    image_figures = ImageFigures.from_image(255 - image(1.5), upright(), ROWS, is_dark=False)
    assert image_figures.edge_px == pytest.approx(figures_of(image(1.5), upright()).edge_px)
    assert image_figures.contrast == pytest.approx((215 - 95) / (215 + 95), abs=0.01)
    assert image_figures.line_spread < 0.5


def test_a_floor_and_a_line_of_one_brightness_each_are_even():
    image_figures = figures_of(image(1.0), upright())
    assert image_figures.mottling_percent < 0.5
    assert image_figures.line_spread < 0.5


def test_the_spread_on_the_line_is_that_of_what_lies_on_it():
    """Noise of 4 grey values everywhere, rounded."""
    figure = figures_of(image(1.5, noise=4.0), upright()).line_spread
    assert figure == pytest.approx(np.hypot(4.0, np.sqrt(1 / 12)), rel=0.05)


def test_the_slope_of_a_spectrum_and_its_high_share_are_those_of_the_drawn_noise():
    """Noise whose power falls with the third power of the frequency; above 0.25 of 0.5 cycles lies a known share."""
    f = np.hypot(np.fft.fftfreq(120)[:, None], np.fft.fftfreq(160)[None, :])
    drawn = np.random.Generator(np.random.PCG64(2)).standard_normal((120, 160))
    f[0, 0] = np.inf
    # Below 0.03 cycles a pixel the power is even, so that the share does not hang on a few components.
    shaped = np.fft.ifft2(np.fft.fft2(drawn) * np.maximum(f, 0.03) ** -1.5).real
    grey = np.clip(128 + 25 * shaped / shaped.std(), 0, 255).astype(np.uint8)
    image_figures = figures_of(np.repeat(grey[..., None], 3, axis=2), np.full(3, np.nan))
    power = np.maximum(f, 0.03) ** -3.0
    power[0, 0] = 0
    assert image_figures.spectrum_slope == pytest.approx(-3.0, abs=0.15)
    assert image_figures.high_frequency_percent == pytest.approx(
        100 * power[f > 0.25][:-1].sum() / power.sum(), rel=0.25
    )


def test_a_straight_edge_is_not_jagged_and_a_shaken_one_by_what_it_was_shaken():
    rng = np.random.Generator(np.random.PCG64(4))
    shaken = MIDDLE + 0.3 * rng.standard_normal(120)
    x = np.arange(160)

    def drawn(middle):
        off = np.abs(x[None, :] - middle[:, None]) - 20
        grey = LINE + (FLOOR - LINE) * np.clip(off / 4 + 0.5, 0, 1)
        return np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=2)

    assert figures_of(drawn(np.full(120, MIDDLE)), upright()).jaggedness_px < 0.01
    assert figures_of(drawn(shaken), upright()).jaggedness_px == pytest.approx(0.3, rel=0.2)
