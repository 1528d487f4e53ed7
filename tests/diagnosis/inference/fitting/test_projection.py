"""Against numpy's own QR and projections written out."""

import numpy as np
import pytest

from diagnosis.inference.fitting.projection import beyond, orthonormal


def test_parts_beyond_a_span_are_orthonormal_and_span_what_they_should():
    generator = np.random.default_rng(4)
    basis, _ = np.linalg.qr(generator.standard_normal((60, 5)))
    columns = generator.standard_normal((60, 3)) * [1.0, 1e-6, 1e6]
    taken = basis.T @ columns
    combined = beyond(columns, taken)
    free = columns @ combined - basis @ (taken @ combined)
    assert free.T @ free == pytest.approx(np.eye(3), abs=1e-9)
    assert basis.T @ free == pytest.approx(np.zeros((5, 3)), abs=1e-9)
    expected, _ = np.linalg.qr(columns / [1.0, 1e-6, 1e6] - basis @ (taken / [1.0, 1e-6, 1e6]))
    assert free @ free.T == pytest.approx(expected @ expected.T, abs=1e-9)


def test_columns_within_the_span_or_of_zeros_add_nothing():
    basis, _ = np.linalg.qr(np.random.default_rng(5).standard_normal((40, 4)))
    columns = np.stack([basis @ [1.0, 2.0, 0.0, -1.0], np.zeros(40), np.arange(40.0)], axis=1)
    assert beyond(columns, basis.T @ columns).shape == (3, 1)


def test_a_basis_has_as_many_columns_as_their_rank():
    columns = np.random.default_rng(6).standard_normal((30, 2)) @ np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]])
    found = orthonormal(columns)
    assert found.shape == (30, 2)
    assert found @ (found.T @ columns) == pytest.approx(columns)
