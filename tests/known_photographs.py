"""Photographs of which everything is known, drawn without the code that measures them."""

import cv2
import numpy as np

FLOOR, LINE = 0.42, 0.06
"""Light on the middle of the sensor, 1 for white."""


def coded(linear):
    """The transfer function of sRGB (IEC 61966-2-1), which is the tone curve of contrast 1 below its shoulder."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def photograph(
    number, blur_px=1.2, loss=0.3, shot=0.0, read=0.0, slant=0.1, line=LINE, floor=FLOOR, width_px=36.0, taper=0.0
):
    """An image (120, 160, 3): a line on an even floor, with blur, vignetting, noise and the curve of sRGB.

    The line is `width_px` wide in the middle row, and wider by `taper` in each row below it.
    """
    rng = np.random.Generator(np.random.PCG64(number))
    y, x = np.mgrid[0:480, 0:640] / 4 - 0.375
    middle = 79.5 + rng.uniform(-8, 8) + slant * (y - 59.5)
    fine = np.where(np.abs(x - middle) < 0.5 * (width_px + taper * (y - 59.5)), line, floor)
    light = cv2.GaussianBlur(cv2.resize(fine, (160, 120), interpolation=cv2.INTER_AREA), (0, 0), blur_px)
    v, u = np.mgrid[0:120, 0:160]
    light = light * (1 - loss * ((u - 79.5) ** 2 + (v - 59.5) ** 2) / (80**2 + 60**2))
    light = light + np.sqrt(shot**2 * light + read**2) * rng.standard_normal(light.shape)
    grey = np.clip(np.rint(255 * coded(light)), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)
