"""Sharpness of the light on the pixels: point spread of the lens, focus, the area of a pixel, and glare."""

from functools import lru_cache

import cv2
import numpy as np

from symolo.core.arrays import FloatImage

_FINER = 16
"""Points per pixel and axis with which the area of a blur disc in a pixel is measured."""


def blurred(light: FloatImage, sd_px: float) -> FloatImage:
    """Return light behind a lens with a Gaussian point spread, whose transfer is exp(-2 (pi f sd)^2)."""
    return cv2.GaussianBlur(light, (0, 0), sd_px).astype(np.float32) if sd_px > 0 else light


def defocused(light: FloatImage, diameter_px: float) -> FloatImage:
    """Return light out of focus: each point becomes an even disc (the circle of confusion) of this diameter."""
    if diameter_px <= 1:  # the disc lies within its pixel
        return light
    return cv2.filter2D(light, cv2.CV_32F, disc(diameter_px)).astype(np.float32, copy=False)


@lru_cache(maxsize=4)
def disc(diameter_px: float) -> FloatImage:
    """Return the shares (K, K) of an even disc's light in the pixels around its middle; their sum is 1."""
    reach = int(np.ceil(0.5 * diameter_px - 0.5))
    at = (np.arange((2 * reach + 1) * _FINER) + 0.5) / _FINER - (reach + 0.5)
    inside = at[:, None] ** 2 + at[None, :] ** 2 <= 0.25 * diameter_px**2
    shares = inside.reshape(2 * reach + 1, _FINER, 2 * reach + 1, _FINER).mean(axis=(1, 3))
    return (shares / shares.sum()).astype(np.float32)


def integrated_over_pixel(light: FloatImage, width_px: float) -> FloatImage:
    """Return the light of pixels that gather it over a square of this width, 1 or more pixels of the image."""
    if width_px == 1:
        return light
    shares = box(width_px)
    return cv2.sepFilter2D(light, cv2.CV_32F, shares, shares).astype(np.float32, copy=False)


def box(width_px: float) -> FloatImage:
    """Return the shares (K,) of the pixels in an interval of this width around the middle of one; their sum is 1."""
    reach = int(np.ceil(0.5 * width_px - 0.5))
    at = np.arange(-reach, reach + 1)
    covered = np.minimum(at + 0.5, 0.5 * width_px) - np.maximum(at - 0.5, -0.5 * width_px)
    return (np.maximum(covered, 0.0) / width_px).astype(np.float32)


def with_veiling_glare(light: FloatImage, share: float) -> FloatImage:
    """Return light of which a share is spread evenly over the image (veiling glare, ISO 9358)."""
    if share == 0:
        return light
    veil = light.mean(axis=(0, 1), dtype=np.float64).astype(np.float32)
    return light + np.float32(share) * (veil - light)
