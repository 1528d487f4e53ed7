"""Where the search for an effect begins."""

import numpy as np
import pytest

from diagnosis.inference.scan import _tried


@pytest.mark.parametrize("size_A", [1.0, 0.06, 40.0])
def test_limits_are_tried_between_the_samples_whatever_their_size(evidence_of, effect, size_A):
    """Currents are even from -1 to 1 times a size, so that a share of them is below the same share of the size."""
    x = np.linspace(-size_A, size_A, 1000)
    (tried,) = _tried(evidence_of(x, x, heldout=0), effect("current_limit"))
    shares = np.exp(tried) / size_A
    assert shares.min() == pytest.approx(0.2, abs=0.01)
    assert shares.max() == pytest.approx(0.997, abs=0.002)
    assert np.diff(np.sort(shares))[-6:].max() < 0.04
