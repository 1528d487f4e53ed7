"""Check for NaN and infinity where numbers come in: one NaN would silently spread through a whole run."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def require_finite(values: NDArray[np.float64], name: str, axes: Sequence[str]) -> None:
    """Refuse NaN and infinity.

    Args:
        values: Numbers of any shape.
        name: Name of the numbers, with their unit, for the message.
        axes: Noun for the index of each axis, in the singular, such as `row`.

    Raises:
        ValueError: A number is not finite; the first one and its place are named.
    """
    is_finite = np.isfinite(values)
    bad = is_finite.size - np.count_nonzero(is_finite)
    if bad:
        first = tuple(int(index) for index in np.unravel_index(np.argmin(is_finite), is_finite.shape))
        where = ", ".join(f"{axis} {index}" for axis, index in zip(axes, first, strict=True))
        raise ValueError(f"{name}: {values[first]} at {where}, {bad} such in all; give finite numbers")
