"""A small model whose network is never used, and grids with values that a pencil gives."""

import numpy as np
import pytest

from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from pipeline.baselines.learned.model import LocalisationModel, ModelAbout


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
    likelihood = even(0.1)
    grid = likelihood.grid
    about = ModelAbout(
        arena="0" * 64,
        inputs=("images", "ranges"),
        x_m=grid.x_m,
        y_m=grid.y_m,
        cell_m=grid.cell_m,
        columns=grid.columns,
        rows=grid.rows,
        headings=grid.headings,
        temperature=1.5,
        wrong=0.1,
        seed=1,
        training_runs=("0123456789abcdef",),
        validation_runs=("fedcba9876543210",),
        epochs=7,
        made_with={},
    )
    return LocalisationModel(about, likelihood, {"head.0.weight": np.arange(6.0).reshape(2, 3).astype(np.float32)})
