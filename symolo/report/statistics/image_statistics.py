"""Numbers about each image: its brightness, its share of clipped pixels, its sharpness."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.brightness import BLACK_UP_TO, BURNT_FROM
from symolo.dataset.tables.rows import Ints
from symolo.reader.run import Run
from symolo.report.statistics.run_facts import fresh

GREYS = 256


@dataclass(frozen=True)
class ImageNumbers:
    """Statistics of the images of one run, in the order of their numbers; grey values are ITU-R BT.601, 0 to 255."""

    run: str
    numbers: tuple[int, ...]
    brightness: Array
    """(M,), mean grey value."""
    black: Array
    """(M,), share of the pixels up to `BLACK_UP_TO`, 0 to 1."""
    burnt: Array
    """(M,), share of the pixels from `BURNT_FROM` on, 0 to 1."""
    sharpness: Array
    """(M,), standard deviation of the grey image's Laplacian; the root of Pech-Pacheco's measure (ICPR 2000)."""
    pixels: Ints
    """(256,), number of pixels of all images with each grey value."""


def image_numbers(run: Run, on_image: Callable[[int], None]) -> ImageNumbers:
    """Return the statistics of the images of one run; only one image is in memory at a time.

    Args:
        run: The run with the images.
        on_image: Called after each image with the number of images done.

    Raises:
        InputError: An image is missing or cannot be decoded.
    """
    import cv2  # noqa: PLC0415 - takes half a second, which readers of tables need not wait for

    statistics, numbers, pixels = [], [], np.zeros(GREYS, np.int64)
    for done, image in enumerate(fresh(run).images, start=1):
        grey = cv2.cvtColor(image.pixels(), cv2.COLOR_RGB2GRAY)
        count = np.bincount(grey.ravel(), minlength=GREYS)
        total = count.sum()
        black, burnt = count[: BLACK_UP_TO + 1].sum() / total, count[BURNT_FROM:].sum() / total
        sharpness = float(cv2.Laplacian(grey, cv2.CV_16S).std())
        statistics.append((float(count @ np.arange(GREYS) / total), float(black), float(burnt), sharpness))
        numbers.append(image.number)
        pixels += count
        on_image(done)
    brightness, black, burnt, sharpness = np.array(statistics, np.float64).reshape(-1, 4).T
    return ImageNumbers(run.name, tuple(numbers), brightness, black, burnt, sharpness, pixels)
