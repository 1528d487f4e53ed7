"""The array types of the whole tree."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Numbers in double precision; each use states shape and unit."""

FloatImage = NDArray[np.float32]
"""Image (H, W, K) in single precision, such as linear light, depths or masks; the first row is at the top."""


def triple(values: NDArray[np.floating]) -> tuple[float, float, float]:
    """Return the numbers of an array (3,) as floats."""
    a, b, c = values.tolist()
    return a, b, c
