"""How alike two files are: a decibel number, and where they differ most."""

import math
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Likeness:
    """Of a file to another one that is not the same bytes."""

    level_db: float
    """Peak over root mean square of the difference; infinite for equal values, minus infinite for what is not alike."""
    what: str
    """The largest difference and where it is."""

    @classmethod
    def none(cls, what: str) -> "Likeness":
        """Of things that cannot be held against each other."""
        return cls(-math.inf, what)


EQUAL = Likeness(math.inf, "")


def level_db(differences: Array, peak: float) -> float:
    """20 log10(peak / rms of the differences) [dB]; of pictures with full scale for the peak, this is the PSNR."""
    # As Huynh-Thu and Ghanbari, Electronics Letters 44 (2008), write the PSNR.
    mean_square = float(np.mean(np.square(differences, dtype=np.float64))) if differences.size else 0.0
    if mean_square == 0:
        return math.inf
    return 10 * math.log10(peak * peak / mean_square) if peak > 0 else -math.inf


def shown_db(value: float) -> str:
    if math.isinf(value):
        return "the same values" if value > 0 else "not alike"
    return f"{value:.1f} dB"
