"""Orthonormal bases of spans, and of what lies outside a span."""

import numpy as np

from symolo.core.arrays import Array

MIN_SHARE = 1e-10
"""Share of a column's square outside a span, below which it is only rounding error."""


def orthonormal(columns: Array) -> Array:
    """Return an orthonormal basis of the span of columns; dependent columns are left out."""
    if columns.shape[1] == 0:
        return columns
    vectors, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return vectors[:, sizes > 1e-7 * max(float(sizes.max(initial=0.0)), 1e-300)]


def beyond(columns: Array, taken: Array) -> Array:
    """Return how to combine columns so that their parts outside a span are orthonormal.

    It uses inner products only, so that a few rows of a long basis are enough.

    Args:
        columns: (n, k), 0 in the other rows of the basis.
        taken: (p, k), inner products of the span's orthonormal basis with the columns.

    Returns:
        (k, r) with r at most k: the parts of `columns @ result` outside the span are orthonormal.
    """
    # Columns of unit length, so that one threshold holds for columns of any unit.
    length = np.sqrt((columns**2).sum(axis=0))
    unit = np.divide(1.0, length, out=np.zeros_like(length), where=length > 0.0)
    inner = (columns.T @ columns - taken.T @ taken) * unit * unit[:, None]
    sizes, vectors = np.linalg.eigh(inner)
    outside = sizes > MIN_SHARE
    return unit[:, None] * vectors[:, outside] / np.sqrt(sizes[outside])
