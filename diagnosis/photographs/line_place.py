"""Where a line lies in an image: a band of even width, darker or lighter than what is on both sides of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.stats import theilslopes

from symolo.core.arrays import Array

BgrImage = NDArray[np.uint8]
"""(H, W, 3), blue first."""

_SAMPLED_ROWS = 60
_MEASURED_ROWS = 9
_BORDER_SHARE = 0.06
"""Share of the rows at the top and at the bottom in which no line is looked for: robots often see themselves there."""
MIN_SHARE = 0.4
"""Smallest share of the rows of an image in which its line must be visible."""
_MIN_DIFFERENCE = 12.0
"""Smallest difference between the grey values of line and floor."""
MIN_WIDTH_PX = 14.0
"""Smallest width of a line that has a level of its own between its blurred edges."""
_MAX_WIDTH_SHARE = 0.45
"""Largest width of a line, as a share of that of the image."""
_MAX_SLOPE = 1.1
"""Largest slope of a line against the columns; a steeper one is measured in the turned image."""
_SMOOTHED_SHARE = 1 / 80
_LIGHT_SHARE = 1 / 6
"""Standard deviations, as shares of the width of the image, of the blur against texture, and of that which leaves the
uneven light."""


@dataclass(frozen=True)
class LinePlace:
    """Place of a line in an image, which is turned if that is needed for the line to run from top to bottom."""

    image: BgrImage
    """The image; its axes are exchanged if `is_turned`."""
    is_turned: bool
    is_dark: bool
    """Whether the line is darker than the floor."""
    width_px: float
    """Median width along a row."""
    rows_px: tuple[float, ...]
    x_px: Array
    """(R,), middle of the line in each of these rows."""
    widths_px: Array
    """(R,), width along each of these rows, which changes evenly: a line that is farther off at the top tapers."""

    @property
    def shape(self) -> tuple[int, int]:
        """Return height and width of the image [px]."""
        height, width, _ = self.image.shape
        return height, width

    @property
    def upright_size_px(self) -> tuple[int, int]:
        """Return width and height of the image before it was turned."""
        height, width = self.shape
        return (height, width) if self.is_turned else (width, height)

    def edges_px(self, rows: Array) -> tuple[Array, Array]:
        """Return where the left and the right edge of the line are in rows (N,), each (N,)."""
        middle, width = (np.interp(rows, self.rows_px, each) for each in (self.x_px, self.widths_px))
        return middle - 0.5 * width, middle + 0.5 * width


@dataclass(frozen=True)
class _Band:
    """Runs of pixels in rows that continue one another."""

    rows: list[int]
    middles_px: list[float]
    widths_px: list[float]

    @property
    def width_px(self) -> float:
        return float(np.median(self.widths_px))

    @property
    def slope(self) -> float:
        return abs(float(np.polyfit(self.rows, self.middles_px, 1)[0])) if len(self.rows) > 1 else np.inf


def find_lines(images: Sequence[BgrImage]) -> tuple[LinePlace | None, ...]:
    """Return the place of the clearest line in each image; None where there is none.

    An image is divided by Otsu's threshold, as it is and without its uneven light. A line is a band that continues
    from row to row with the same width and has floor on both sides. The one with the largest product of length and
    contrast counts. All images show the same line, so it is dark in all of them or light in all of them.
    """
    best = [_best(image) for image in images]
    total = {is_dark: sum(each[is_dark][0] for each in best if is_dark in each) for is_dark in (True, False)}
    is_dark = total[True] >= total[False]
    return tuple(each[is_dark][1] if is_dark in each else None for each in best)


def _best(image: BgrImage) -> dict[bool, tuple[float, LinePlace]]:
    """Return the score and place of the best dark line and of the best light one, as far as there are any."""
    best: dict[bool, tuple[float, LinePlace]] = {}
    for is_turned in (False, True):
        seen = np.ascontiguousarray(image.transpose(1, 0, 2)) if is_turned else image
        grey = cv2.cvtColor(seen, cv2.COLOR_BGR2GRAY).astype(np.float64)
        for is_dark, mask in _masks(grey):
            band = _longest_band(mask)
            if band is None or band.slope > _MAX_SLOPE:
                continue
            share, difference = len(band.rows) / len(_rows(len(grey))), _difference(grey, band, is_dark=is_dark)
            if share < MIN_SHARE or difference < _MIN_DIFFERENCE:
                continue
            if is_dark not in best or share * difference > best[is_dark][0]:
                best[is_dark] = share * difference, _place(seen, band, is_turned=is_turned, is_dark=is_dark)
    return best


def _rows(height: int) -> list[int]:
    border = _BORDER_SHARE * height
    return np.unique(np.linspace(border, height - 2 - border, _SAMPLED_ROWS).round().astype(int)).tolist()


def _masks(grey: Array) -> Iterator[tuple[bool, NDArray[np.bool_]]]:
    """Yield whether a mask shows what is dark, and the mask."""
    width = max(grey.shape)
    smooth = cv2.GaussianBlur(grey, (0, 0), max(1.0, _SMOOTHED_SHARE * width))
    for levels in (smooth, smooth - cv2.GaussianBlur(smooth, (0, 0), _LIGHT_SHARE * width)):
        low, high = levels.min(), levels.max()
        scaled = (255 * (levels - low) / max(high - low, 1e-6)).astype(np.uint8)
        _, bright = cv2.threshold(scaled, 0, 1, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
        yield True, bright == 0
        yield False, bright == 1


def _longest_band(mask: NDArray[np.bool_]) -> _Band | None:
    height, width = mask.shape
    rows = _rows(height)
    runs = [_inner_runs(mask[row], width) for row in rows]
    bands = []
    for start in range(0, len(rows), 6):
        for first in runs[start]:
            up, down = (_followed(runs, start, first, step) for step in (-1, 1))
            places = [*reversed(up), (start, first), *down]
            middles, widths = zip(*((0.5 * (a + b - 1), float(b - a)) for _, (a, b) in places), strict=True)
            bands.append(_Band([rows[k] for k, _ in places], list(middles), list(widths)))
    return max(bands, key=lambda band: len(band.rows), default=None)


def _inner_runs(row: NDArray[np.bool_], width: int) -> list[tuple[int, int]]:
    """Return the first pixel and the end of each run that has other pixels on both sides."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], row.astype(np.int8), [0]]))).reshape(-1, 2)
    return [
        (int(a), int(b)) for a, b in edges if a > 0 and b < width and MIN_WIDTH_PX <= b - a <= _MAX_WIDTH_SHARE * width
    ]


def _followed(
    runs: list[list[tuple[int, int]]], start: int, first: tuple[int, int], step: int
) -> list[tuple[int, tuple[int, int]]]:
    """Return the rows and runs that continue a run upwards or downwards; one row in a row may be missing."""
    places: list[tuple[int, tuple[int, int]]] = []
    before, missing, k = first, 0, start + step
    while 0 <= k < len(runs) and missing < 2:
        here = 0.5 * sum(before)
        width = before[1] - before[0]
        near = [run for run in runs[k] if abs(0.5 * sum(run) - here) < 0.5 * width * (1 + missing)]
        alike = [run for run in near if 0.7 < (run[1] - run[0]) / width < 1.4]
        if alike:
            before, missing = min(alike, key=lambda run: abs(0.5 * sum(run) - here)), 0
            places.append((k, before))
        else:
            missing += 1
        k += step
    return places


def _difference(grey: Array, band: _Band, *, is_dark: bool) -> float:
    """Return the median difference between the grey values on both sides of a band and on it."""
    half = 0.5 * band.width_px
    differences = []
    for row, middle in zip(band.rows, band.middles_px, strict=True):
        inside = grey[row, round(middle - 0.3 * half) : round(middle + 0.3 * half) + 1]
        beside = (round(middle - 1.5 * half), round(middle + 1.5 * half))
        outside = [grey[row, x] for x in beside if 0 <= x < grey.shape[1]]
        differences += [level - np.median(inside) for level in outside]
    return float(np.median(differences)) * (1 if is_dark else -1) if differences else 0.0


def _place(image: BgrImage, band: _Band, *, is_turned: bool, is_dark: bool) -> LinePlace:
    chosen = np.unique(np.linspace(0, len(band.rows) - 1, _MEASURED_ROWS).round().astype(int))
    taper, at_zero, *_ = theilslopes(band.widths_px, band.rows)
    return LinePlace(
        image=image,
        is_turned=is_turned,
        is_dark=is_dark,
        width_px=band.width_px,
        rows_px=tuple(band.rows[k] + 0.5 for k in chosen),
        x_px=np.array([band.middles_px[k] for k in chosen]),
        widths_px=at_zero + taper * np.array([band.rows[k] for k in chosen]),
    )
