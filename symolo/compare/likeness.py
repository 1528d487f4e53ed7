"""Likeness of two files: a level in decibels, and the largest difference."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Likeness:
    """Likeness of a file to another file with other bytes."""

    level_db: float
    """Peak over root mean square of the difference [dB]; inf for equal values, -inf for files without likeness."""
    what: str
    """Description of the largest difference and its place; of a JSON file, those of up to five."""

    @classmethod
    def none(cls, what: str) -> "Likeness":
        """Return the likeness of contents that cannot be compared."""
        return cls(-math.inf, what)


EQUAL = Likeness(math.inf, "")


def level_db(differences: np.ndarray, peak: float) -> float:
    """Return 20 log10(peak / rms of the differences) [dB]; with full scale as the peak, this is the PSNR of images.

    Definition of the PSNR: Huynh-Thu and Ghanbari, Electronics Letters 44 (2008).
    """
    with np.errstate(over="ignore"):  # numbers beyond 1e154 have no square; no likeness is their level
        mean_square = float(np.mean(np.square(differences, dtype=np.float64))) if differences.size else 0.0
    if mean_square == 0:
        return math.inf
    ratio = peak / math.sqrt(mean_square) if math.isfinite(mean_square) else 0.0
    return 20 * math.log10(ratio) if ratio > 0 else -math.inf


def shown_db(value: float) -> str:
    if math.isinf(value):
        return "the same values" if value > 0 else "not alike"
    return f"{value:.1f} dB"
