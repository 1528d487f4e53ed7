"""The array types of the whole tree, and what numpy lacks for them."""

from collections.abc import Sequence

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


def stacked_rows(rows: Sequence[float | Array], shape: tuple[int, ...] = ()) -> Array:
    """Return rows that broadcast to each other as one array (T, ...), as a copy.

    `numpy.stack` of `numpy.broadcast_arrays` does the same, but takes several times as long for many small rows.

    Args:
        rows: T of them.
        shape: Shape to which they broadcast as well.
    """
    shape = np.broadcast_shapes(shape, *{row.shape if isinstance(row, np.ndarray) else () for row in rows})
    stacked = np.empty((len(rows), *shape))
    for k, row in enumerate(rows):
        stacked[k] = row
    return stacked
