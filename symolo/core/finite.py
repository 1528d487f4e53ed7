"""Numbers that are none, refused where they come in: one NaN would spread through a whole run in silence."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def require_finite(values: NDArray[np.float64], name: str, axes: Sequence[str]) -> None:
    """Refuse NaN and infinity.

    Args:
        values: Of any shape.
        name: What they are, with their unit.
        axes: What each axis of them counts, in the singular.

    Raises:
        ValueError: Names the first one and where it stands.
    """
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        first = tuple(bad[0].tolist())
        where = ", ".join(f"{axis} {index}" for axis, index in zip(axes, first, strict=True))
        raise ValueError(f"{name}: {values[first]} at {where}, {len(bad)} such in all; give finite numbers")
