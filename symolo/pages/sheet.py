"""Images in rows, with lines of text below each: the layout of contact sheets and previews."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_file

Pixels = NDArray[np.uint8]

LINE_PX = 18
MAX_SIDE_PX = 65_500
"""JPEG_MAX_DIMENSION of libjpeg's jmorecfg.h. It is checked here, since OpenCV would only print a line."""
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_SCALE = 0.4
_MARGIN_PX = 3


@dataclass(frozen=True)
class Cell:
    """One image of a sheet."""

    image: Pixels
    """(H, W, 3) BGR."""
    lines: tuple[str, ...]
    """Lines of text below it; all cells of a row have the same number of lines."""


def row(cells: Sequence[Cell], width_px: int) -> Pixels:
    """Return images of one shape side by side, each `width_px` wide, (H, W, 3) BGR."""
    return np.concatenate([_drawn(cell, width_px) for cell in cells], axis=1)


def stacked(rows: Sequence[Pixels]) -> Pixels:
    """Return rows below each other, filled with black to the width of the widest row."""
    widest = max(row.shape[1] for row in rows)
    return np.concatenate([np.pad(row, ((0, 0), (0, widest - row.shape[1]), (0, 0))) for row in rows])


def in_columns(cells: Sequence[Cell], columns: int) -> Pixels:
    """Return cells as wide as the first one in rows of so many, (H, W, 3) BGR."""
    width_px = cells[0].image.shape[1]
    return stacked([row(cells[i : i + columns], width_px) for i in range(0, len(cells), columns)])


def check_side(which: str, length_px: int, smaller: str) -> None:
    """Raise InputError for a sheet that is too large for an image file; `smaller` names the option to reduce."""
    if length_px > MAX_SIDE_PX:
        raise InputError(
            f"the sheet would be too {which}",
            got=f"{length_px} px",
            allowed=f"up to {MAX_SIDE_PX} px",
            cure=f"choose a smaller {smaller}",
        )


def save(sheet: Pixels, path: Path) -> None:
    """Write the sheet in the format of the file's extension, JPEG or PNG."""
    encoded, data = cv2.imencode(path.suffix, sheet)
    if not encoded:
        raise InputError("cannot be encoded", where=str(path))
    write_file(path, data.tobytes())


def _drawn(cell: Cell, width_px: int) -> Pixels:
    height_px = round(cell.image.shape[0] * width_px / cell.image.shape[1])
    method = cv2.INTER_AREA if width_px < cell.image.shape[1] else cv2.INTER_NEAREST
    small = np.asarray(cv2.resize(cell.image, (width_px, height_px), interpolation=method), np.uint8)
    return np.concatenate((small, *(text_line(line, width_px) for line in cell.lines)))


def text_line(line: str, width_px: int) -> Pixels:
    """Return a line of white text on black, in a smaller font if it would be too long."""
    strip = np.zeros((LINE_PX, width_px, 3), np.uint8)
    (length_px, _), _ = cv2.getTextSize(line, _FONT, _SCALE, 1)
    scale = _SCALE * min(1.0, (width_px - 2 * _MARGIN_PX) / max(length_px, 1))
    cv2.putText(strip, line, (_MARGIN_PX, LINE_PX - 5), _FONT, scale, (255, 255, 255), 1, cv2.LINE_AA)
    return strip
