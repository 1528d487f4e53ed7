"""The estimators on images of which the answer is known."""

import importlib

import cv2
import numpy as np
import pytest

LINE, FLOOR = 40.0, 160.0
MIDDLE = 79.5


@pytest.fixture
def figures():
    return importlib.import_module("photograph_figures")


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


def test_an_edge_is_as_wide_as_its_blur(figures):
    """10 to 90 % of an error function are 2.563 standard deviations; a pixel's width adds 1/12 to the variance."""
    sd = np.hypot(1.5, np.sqrt(1 / 12))
    assert figures.ImageFigures.of(image(1.5), upright()).edge_px == pytest.approx(2.563 * sd, rel=0.05)


def test_an_edge_counts_square_to_itself(figures):
    """A line slanted by 30 degrees has the same blur and a longer way through it along the row."""
    slant = np.tan(np.radians(30))
    x_px = MIDDLE + slant * (np.array([31.5, 59.5, 87.5]) - 59.5)
    wide = figures.ImageFigures.of(image(1.5, slant=slant), x_px).edge_px
    assert wide == pytest.approx(2.563 * np.hypot(1.5, np.sqrt(1 / 12)), rel=0.08)


def test_noise_is_what_was_added(figures):
    """Rounding to whole grey values adds 1/12 to the variance."""
    found = figures.ImageFigures.of(image(1.5, noise=3.0), upright()).noise
    assert found == pytest.approx(np.hypot(3.0, np.sqrt(1 / 12)), rel=0.05)


def test_contrast_and_range_are_those_drawn(figures):
    found = figures.ImageFigures.of(image(1.0), upright())
    assert found.contrast == pytest.approx((FLOOR - LINE) / (FLOOR + LINE), abs=0.01)
    assert (found.black, found.white, found.saturation_percent) == (LINE, FLOOR, 0)


def test_a_floor_and_a_line_of_one_brightness_each_are_even(figures):
    found = figures.ImageFigures.of(image(1.0), upright())
    assert found.mottling_percent < 0.5
    assert found.line_spread < 0.5


def test_the_spread_on_the_line_is_that_of_what_lies_on_it(figures):
    """Noise of 4 grey values everywhere, rounded."""
    found = figures.ImageFigures.of(image(1.5, noise=4.0), upright()).line_spread
    assert found == pytest.approx(np.hypot(4.0, np.sqrt(1 / 12)), rel=0.05)
