"""The real frames, with the places of their line as camera_line_photos.csv has them."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from line_frames import ROWS, Array, LabelledFrames
from numpy.typing import NDArray

LABELS = Path(__file__).with_name("camera_line_photos.csv")


@dataclass(frozen=True)
class Photographs:
    names: tuple[str, ...]
    images: NDArray[np.uint8]
    """(N, H, W, 3), blue first."""
    x_px: Array
    """(N, len(ROWS)), NaN where there is no label."""

    def labelled(self) -> LabelledFrames:
        """Return those with at least one label, each as a group."""
        has = np.flatnonzero(np.isfinite(self.x_px).any(axis=1))
        return LabelledFrames(self.images[has], self.x_px[has], has)


def photographs(folder: Path, *, branch: bool) -> Photographs:
    """Return the labels of the rows with a branch beside the line, or of the rows without one.

    Raises:
        SystemExit: A photograph is missing.
    """
    lines = [line.split(",") for line in LABELS.read_text().splitlines() if line.startswith("img")]
    names = sorted({line[0] for line in lines})
    x_px = np.full((len(names), len(ROWS)), np.nan)
    for name, row, left, right, has_branch in lines:
        if int(has_branch) == branch:
            x_px[names.index(name), ROWS.index(float(row))] = 0.5 * (float(left) + float(right))
    images = [cv2.imread(str(folder / name)) for name in names]
    if missing := [name for name, image in zip(names, images, strict=True) if image is None]:
        raise SystemExit(f"{folder}: no photograph {missing[0]}; name the folder that SOURCE.md lies in")
    return Photographs(tuple(names), np.array(images, np.uint8), x_px)
