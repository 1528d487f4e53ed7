"""Views of two files that differ: images beside their difference, and the curves of the worst column of tables."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePosixPath

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.compare import images, tables
from symolo.compare.images import is_of_ids
from symolo.dataset.pixels import decoded_bytes

Pixels = NDArray[np.uint8]
_WIDTH_PX = 320
_QUALITY = 88


@dataclass(frozen=True)
class ImagePair:
    """Two images and their difference, as JPEG."""

    a: bytes
    b: bytes
    difference: bytes
    """Largest difference of the channels of each pixel; empty for images of different sizes."""
    gain: float
    """Factor by which the difference is brightened; 0 if there is no difference image."""


@dataclass(frozen=True)
class ColumnPair:
    """The column of two tables that differs most."""

    name: str
    plot: bytes
    """Plot as SVG."""


def image_pair(a: bytes, b: bytes, name: str) -> ImagePair | None:
    """Return two images with their difference; None if one of them cannot be decoded.

    Args:
        a: An image file.
        b: Another one.
        name: Path in the dataset; pixels that are ids get colours, and differ or not.
    """
    one, other = decoded_bytes(a), decoded_bytes(b)
    if one is None or other is None:
        return None
    shown = _coloured if is_of_ids(name) else _greyed(one, other)
    if one.shape != other.shape:
        return ImagePair(_jpeg(shown(one)), _jpeg(shown(other)), b"", 0.0)
    difference = np.abs(one.astype(np.float64) - other).reshape(*one.shape[:2], -1).max(axis=2)
    if shown is _coloured:
        difference = 255.0 * (difference > 0)
    largest = float(difference.max())
    gain = 255.0 / largest if largest > 0 else 1.0
    return ImagePair(_jpeg(shown(one)), _jpeg(shown(other)), _jpeg(np.rint(gain * difference).astype(np.uint8)), gain)


def _greyed(a: np.ndarray, b: np.ndarray) -> Callable[[np.ndarray], Pixels]:
    """Return a function that shows both images with the same brightness; those of 8 bits stay as they are."""
    if a.dtype == np.uint8 and b.dtype == np.uint8:
        return lambda pixels: np.asarray(pixels, np.uint8)
    largest = max(float(a.max()), float(b.max()), 1.0)
    return lambda pixels: np.rint(255.0 * pixels.astype(np.float64) / largest).astype(np.uint8)


def _coloured(ids: np.ndarray) -> Pixels:
    """Return a colour for each id; neighbouring ids have colours that are far from each other."""
    hue = (ids.astype(np.int64).reshape(*ids.shape[:2], -1)[..., 0] * 67) % 180
    saturated = np.full_like(hue, 200)
    return np.asarray(
        cv2.cvtColor(np.stack([hue, saturated, saturated], axis=2).astype(np.uint8), cv2.COLOR_HSV2BGR), np.uint8
    )


def _jpeg(pixels: Pixels) -> bytes:
    scale = min(1.0, _WIDTH_PX / pixels.shape[1])
    if scale < 1.0:
        size = (_WIDTH_PX, max(1, round(pixels.shape[0] * scale)))
        pixels = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    return cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1].tobytes()


def column_pair(a: bytes, b: bytes, name: str) -> ColumnPair | None:
    """Return the column that differs most between two tables; None if they have other columns or rows."""
    worst = tables.worst_column(a, b, name)
    if worst is None:
        return None
    from matplotlib.figure import Figure  # noqa: PLC0415 - takes half a second, which a comparison without page saves

    from symolo.pages.plotting import BLACK, BLUE, VERMILION, svg  # noqa: PLC0415

    figure = Figure(figsize=(7.0, 3.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    rows = np.arange(len(worst.a))
    above.plot(rows, worst.a, color=BLACK, linewidth=1.2, label="A")
    above.plot(rows, worst.b, color=BLUE, linewidth=1.2, linestyle=(0, (4.0, 1.5)), label="B")
    above.set_ylabel(worst.name)
    above.legend(fontsize="small")
    below.plot(rows, worst.b - worst.a, color=VERMILION, linewidth=1.0)
    below.set(xlabel="row", ylabel="B - A")
    for axes in (above, below):
        axes.grid(alpha=0.3)
    return ColumnPair(worst.name, svg(figure))


def is_image(name: str) -> bool:
    return PurePosixPath(name).suffix.lower() in images.SUFFIXES


def is_table(name: str) -> bool:
    return PurePosixPath(name).suffix.lower() in tables.SEPARATORS
