"""Spans of directions, and what of other directions lies beyond them."""

import numpy as np

from symolo.core.arrays import Array

NOTHING = 1e-10
"""Share of a column's square that lies beyond a span, up to which it is rounding's."""


def orthonormal(columns: Array) -> Array:
    """A basis of their span; columns that add nothing are left out."""
    if columns.shape[1] == 0:
        return columns
    left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, sizes > 1e-7 * max(float(sizes.max(initial=0.0)), 1e-300)]


def beyond(columns: Array, taken: Array) -> Array:
    """How to combine columns so that what of them lies beyond a span is orthonormal.

    Works on products alone, so that a few rows of a long basis are enough.

    Args:
        columns: (n, k), 0 in the basis's other rows.
        taken: (p, k), the products of an orthonormal basis with them.

    Returns:
        (k, r), so that the parts of `columns @ result` beyond the span are orthonormal; r at most k.
    """
    length = np.sqrt((columns**2).sum(axis=0))
    unit = np.divide(1.0, length, out=np.zeros_like(length), where=length > 0.0)
    inner = (columns.T @ columns - taken.T @ taken) * unit * unit[:, None]
    sizes, vectors = np.linalg.eigh(inner)
    some = sizes > NOTHING
    return unit[:, None] * vectors[:, some] / np.sqrt(sizes[some])
