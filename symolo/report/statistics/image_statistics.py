"""Numbers of each image: how bright, how much of it clipped, how sharp."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.brightness import BLACK_UP_TO, BURNT_FROM
from symolo.dataset.rows import Ints
from symolo.reader.run import Run
from symolo.report.statistics.run_facts import fresh

GREYS = 256


@dataclass(frozen=True)
class ImageNumbers:
    """Of the images of one run, in the order of their numbers; grey values are those of ITU-R BT.601, 0 to 255."""

    run: str
    numbers: tuple[int, ...]
    brightness: Array
    """(M,), mean grey value."""
    black: Array
    """(M,), share of the pixels up to `BLACK_UP_TO`, 0 to 1."""
    burnt: Array
    """(M,), share of the pixels from `BURNT_FROM` on, 0 to 1."""
    sharpness: Array
    """(M,), standard deviation of the grey picture's Laplacian; the root of Pech-Pacheco's measure (ICPR 2000)."""
    pixels: Ints
    """(256,), how many pixels of all images have each grey value."""


def image_numbers(run: Run, looked_at: Callable[[int], None]) -> ImageNumbers:
    """Of one run; no more than one picture is held at a time.

    Args:
        run: Whose images are looked at.
        looked_at: Told the number of images done, after each.

    Raises:
        InputError: An image is missing or no picture.
    """
    import cv2  # noqa: PLC0415 - half a second that whoever reads tables does not need

    told, numbers, pixels = [], [], np.zeros(GREYS, np.int64)
    for done, image in enumerate(fresh(run).images, start=1):
        grey = cv2.cvtColor(image.pixels(), cv2.COLOR_RGB2GRAY)
        count = np.bincount(grey.ravel(), minlength=GREYS)
        told.append((*_levels(count), float(cv2.Laplacian(grey, cv2.CV_16S).std())))
        numbers.append(image.number)
        pixels += count
        looked_at(done)
    brightness, black, burnt, sharpness = np.array(told, np.float64).reshape(-1, 4).T
    return ImageNumbers(run.name, tuple(numbers), brightness, black, burnt, sharpness, pixels)


def _levels(count: Ints) -> tuple[float, float, float]:
    """Mean, share that is black and share that is burnt, of how often each grey value occurs."""
    total = count.sum()
    mean = float(count @ np.arange(GREYS) / total)
    return mean, float(count[: BLACK_UP_TO + 1].sum() / total), float(count[BURNT_FROM:].sum() / total)
