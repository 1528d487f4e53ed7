"""A model of an arena that does not exist, whose network is never used."""

from collections.abc import Sequence

import numpy as np

from pipeline.baselines.learned.heat_map import PoseLikelihood
from pipeline.baselines.learned.model import LocalisationModel, ModelDescription


def small_model(likelihood: PoseLikelihood, inputs: Sequence[str]) -> LocalisationModel:
    """Return a model with this likelihood of poses and six weights."""
    grid = likelihood.grid
    about = ModelDescription(
        arena="0" * 64,
        inputs=tuple(inputs),
        x_m=grid.x_m,
        y_m=grid.y_m,
        cell_m=grid.cell_m,
        columns=grid.columns,
        rows=grid.rows,
        headings=grid.headings,
        temperature=1.5,
        wrong=likelihood.wrong,
        seed=1,
        training_runs=("0123456789abcdef",),
        validation_runs=("fedcba9876543210",),
        epochs=7,
        made_with={"torch": "2.6.0"},
    )
    weights = {"head.0.weight": np.arange(6.0).reshape(2, 3).astype(np.float32), "head.0.bias": np.zeros(2, np.float32)}
    return LocalisationModel(about, likelihood, weights)
