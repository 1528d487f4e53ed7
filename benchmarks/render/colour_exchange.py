"""Diffuse light taken off the colour that a few samples met, and put on that of many."""

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]

_LEAST_COLOUR = 1e-4
"""What is darker has no diffuse light to speak of."""


def exchanged(whole: Image, diffuse: Image, met: Image, colour: Image) -> Image:
    """(H, W, 3) light `whole`, whose part `diffuse` came from the reflectance `met`, as it comes from `colour`."""
    rest = np.maximum(whole - diffuse, 0)
    moved = np.where(met > _LEAST_COLOUR, diffuse / np.maximum(met, _LEAST_COLOUR) * colour, diffuse)
    return (moved + rest).astype(np.float32)
