"""How far one 8-bit image is from another.

PSNR over all pixels and channels; SSIM of Wang et al., "Image quality assessment: from error visibility to structural
similarity", IEEE TIP 13 (2004), eq. 13, of the grey images with its Gaussian window of 11 x 11 px and 1.5 px; FLIP of
Andersson et al. (2020) where NVIDIA's package `flip-evaluator` is installed.
"""

import importlib.util

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
_HALF_WINDOW = 5
_WINDOW_SD_PX = 1.5
_C1, _C2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2

HAS_FLIP = importlib.util.find_spec("flip_evaluator") is not None


def mean_square(image: Image, reference: Image) -> float:
    return float(np.mean((image.astype(np.float64) - reference) ** 2))


def psnr_dB(mean_square_error: float) -> float:
    """Return the PSNR of a mean square error in levels of 255; infinite for none."""
    return float(10 * np.log10(255**2 / mean_square_error)) if mean_square_error else float("inf")


def ssim(image: Image, reference: Image) -> float:
    """Mean over the pixels whose window lies within the (H, W, 3) images."""
    x, y = (cv2.cvtColor(p, cv2.COLOR_RGB2GRAY).astype(np.float64) for p in (image, reference))
    mx, my = _local_mean(x), _local_mean(y)
    vx, vy, cov = _local_mean(x * x) - mx * mx, _local_mean(y * y) - my * my, _local_mean(x * y) - mx * my
    similar = (2 * mx * my + _C1) * (2 * cov + _C2) / ((mx * mx + my * my + _C1) * (vx + vy + _C2))
    return float(similar.mean())


def _local_mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
    window_px = 2 * _HALF_WINDOW + 1
    inner = slice(_HALF_WINDOW, -_HALF_WINDOW)
    return cv2.GaussianBlur(values, (window_px, window_px), _WINDOW_SD_PX)[inner, inner]


def flip(image: Image, reference: Image) -> float | None:
    """Mean of FLIP for low dynamic range at 67 pixels per degree; None without the package."""
    if not HAS_FLIP:
        return None
    import flip_evaluator  # noqa: PLC0415 - optional

    _, mean, _ = flip_evaluator.evaluate(*(p.astype(np.float32) / 255 for p in (reference, image)), "LDR")
    return float(mean)
