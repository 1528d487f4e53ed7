"""Comparison of two images: the PSNR of their pixels, or the number of different pixels where pixels are ids."""

from pathlib import PurePosixPath

import numpy as np

from symolo.compare.likeness import Likeness, level_db
from symolo.dataset.pixels import decoded_bytes

SUFFIXES = frozenset({".jpg", ".jpeg", ".png"})
LABELS = frozenset({"instance", "semantic", "free_floor"})
"""Folders of annotations whose pixels are ids."""


def likeness(a: bytes, b: bytes, name: str) -> Likeness:
    pixels_a, pixels_b = _decoded(a), _decoded(b)
    if pixels_a is None or pixels_b is None:
        which = "A" if pixels_a is None else "B"
        return Likeness.none(f"the image of {which} cannot be decoded")
    if pixels_a.shape != pixels_b.shape or pixels_a.dtype != pixels_b.dtype:
        return Likeness.none(f"{_form(pixels_a)} in A, {_form(pixels_b)} in B")
    differences = pixels_a.astype(np.float64) - pixels_b
    differing = np.count_nonzero(differences.reshape(*differences.shape[:2], -1).any(axis=2))
    shares = f"{differing} of {differences.shape[0] * differences.shape[1]} pixels differ"
    if not differing:
        return Likeness(level_db(differences, 1.0), "the same pixels in other bytes")
    if is_of_ids(name):
        return Likeness.none(f"{shares}, which are ids")
    largest = float(np.max(np.abs(differences)))
    row, column = np.unravel_index(np.argmax(np.abs(differences)), differences.shape)[:2]
    what = f"{shares}, the most by {largest:.0f} at x = {column}, y = {row}"
    return Likeness(level_db(differences, float(np.iinfo(pixels_a.dtype).max)), what)


def _decoded(data: bytes) -> np.ndarray | None:
    pixels = decoded_bytes(data)
    return pixels if pixels is not None and np.issubdtype(pixels.dtype, np.integer) else None


def _form(pixels: np.ndarray) -> str:
    height, width, *channels = pixels.shape
    return f"{width} x {height} px, {channels[0] if channels else 1} channels of {pixels.dtype}"


def is_of_ids(name: str) -> bool:
    """Return whether the pixels of an image are ids of things."""
    return PurePosixPath(name).parent.name in LABELS
