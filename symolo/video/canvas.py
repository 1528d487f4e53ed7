"""A picture in memory on which frames of a video are drawn: areas, lines, texts and images, with smooth edges."""

from collections.abc import Iterator
from functools import cache, lru_cache
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from symolo.core.arrays import Array
from symolo.pages.states import Dash

Pixels = NDArray[np.uint8]
Colour = tuple[int, int, int]
"""Red, green, blue."""
_SHIFT = 4
"""Fractional bits of the coordinates that OpenCV draws with."""


def rgb(code: str) -> Colour:
    """Return the colour of a code such as `#0072B2`."""
    red, green, blue = bytes.fromhex(code.removeprefix("#"))
    return red, green, blue


class Canvas:
    """Pixels (H, W, 3) in red, green and blue; places are x to the right and y down [px]."""

    def __init__(self, pixels: Pixels) -> None:
        self.pixels = pixels

    @classmethod
    def blank(cls, width_px: int, height_px: int, colour: Colour = (255, 255, 255)) -> "Canvas":
        return cls(np.full((height_px, width_px, 3), colour, np.uint8))

    def copy(self) -> "Canvas":
        return Canvas(self.pixels.copy())

    def part(self, x: int, y: int, width_px: int, height_px: int) -> "Canvas":
        """Return a part of this picture; what is drawn on it is drawn on this picture."""
        return Canvas(self.pixels[y : y + height_px, x : x + width_px])

    def area(self, corners: Array, colour: Colour) -> None:
        """Fill a polygon with corners (K, 2)."""
        self._draw(lambda pixels: cv2.fillPoly(pixels, [_fixed(corners)], colour, cv2.LINE_AA, _SHIFT))

    def line(self, points: Array, colour: Colour, width_px: float, dash: Dash = "-", *, closed: bool = False) -> None:
        """Draw a line through points (K, 2); dashes have the lengths of `dash` times the width."""
        pieces = [points] if dash == "-" else list(_dashes(points, [width_px * length for length in dash[1]]))
        lines, thickness = [_fixed(piece) for piece in pieces], max(1, round(width_px))
        self._draw(lambda pixels: cv2.polylines(pixels, lines, closed, colour, thickness, cv2.LINE_AA, _SHIFT))

    def text(self, words: str, x: float, y: float, size_px: float, colour: Colour = (30, 34, 40)) -> float:
        """Write words whose left end on the base line is at (x, y), and return x of their right end."""
        mask, left, top = _letters(words, round(size_px))
        column, row = round(x) + left, round(y) + top
        first_row, first_column = max(-row, 0), max(-column, 0)
        place = self.pixels[max(row, 0) : row + mask.shape[0], max(column, 0) : column + mask.shape[1]]
        ink = mask[first_row:, first_column:][: place.shape[0], : place.shape[1], None]
        place[:] = np.rint(place + ink * (np.array(colour) - place.astype(np.float64)))
        return x + text_width(words, size_px)

    def image(self, pixels: Pixels) -> "Canvas":
        """Show an image as large as fits, in the middle, and return the part that it fills."""
        height_px, width_px = self.pixels.shape[:2]
        scale = min(width_px / pixels.shape[1], height_px / pixels.shape[0])
        size = (max(1, round(pixels.shape[1] * scale)), max(1, round(pixels.shape[0] * scale)))
        method = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
        small = cv2.resize(pixels, size, interpolation=method)
        x, y = (width_px - size[0]) // 2, (height_px - size[1]) // 2
        self.pixels[y : y + size[1], x : x + size[0]] = small
        return self.part(x, y, *size)

    def _draw(self, draw) -> None:  # noqa: ANN001 - a call of OpenCV on an array
        """Draw with OpenCV, which takes no part of an array, so a part is copied."""
        if self.pixels.flags.c_contiguous:
            draw(self.pixels)
            return
        whole = np.ascontiguousarray(self.pixels)
        draw(whole)
        self.pixels[:] = whole


def text_width(words: str, size_px: float) -> float:
    """Return the width of words [px]."""
    return _font(round(size_px)).getlength(words)


def _fixed(points: Array) -> NDArray[np.int32]:
    """Return points with the fractional bits that OpenCV takes."""
    return np.rint(np.asarray(points, np.float64) * (1 << _SHIFT)).astype(np.int32).reshape(-1, 1, 2)


def _dashes(points: Array, pattern: list[float]) -> Iterator[Array]:
    """Yield the dashes of a line through points; dashes and gaps alternate with the lengths of the pattern [px]."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate(([0.0], np.cumsum(steps)))
    start, k = 0.0, 0
    while start < along[-1]:
        end = start + pattern[k % len(pattern)]
        if k % 2 == 0:
            inside = points[(along > start) & (along < end)]
            ends = [[np.interp(at, along, axis) for axis in points.T] for at in (start, min(end, along[-1]))]
            yield np.array([ends[0], *inside, ends[1]])
        start, k = end, k + 1


@cache
def _font(size_px: int) -> ImageFont.FreeTypeFont:
    """Return the font that comes with Matplotlib, so that a video does not depend on the fonts of the machine."""
    return ImageFont.truetype(Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), size_px)


@lru_cache(maxsize=4096)
def _letters(words: str, size_px: int) -> tuple[Array, int, int]:
    """Return the ink of words (H, W) from 0 to 1, and where it begins from the left end of the base line."""
    left, top, right, bottom = (round(end) for end in _font(size_px).getbbox(words, anchor="ls"))
    picture = Image.new("L", (max(right - left, 1), max(bottom - top, 1)))
    ImageDraw.Draw(picture).text((-left, -top), words, fill=255, font=_font(size_px), anchor="ls")
    return np.asarray(picture, np.float64) / 255, left, top
