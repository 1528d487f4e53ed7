"""A small model, and grids with values that a pencil gives."""

import numpy as np
import pytest

from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from tests.pipeline.baselines.learned.small_model import small_model


@pytest.fixture(scope="session")
def grid():
    """Cells of 10 cm and 45 deg."""
    return PoseGrid(-0.5, -0.3, 0.1, 11, 7, 8)


@pytest.fixture
def even(grid):
    """All cells of the grid, with as many training poses in each."""

    def likelihood(wrong):
        count = int(np.prod(grid.shape))
        return PoseLikelihood(grid, np.arange(count), np.full(count, 1.0 / count), wrong)

    return likelihood


@pytest.fixture
def model(even):
    """A model of an arena that does not exist."""
    return small_model(even(0.1), ("images", "ranges"))
