"""The reader of models that `symolo train` wrote, as `readers.py` has it; nothing here needs PyTorch."""

from pathlib import Path

import numpy as np

from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from pipeline.baselines.learned.model import INPUTS, read_model
from tests.fuzz.guard import Read
from tests.pipeline.baselines.learned.small_model import small_model

GRID = PoseGrid(-0.2, -0.1, 0.1, 5, 3, 4)
"""Five by three cells of 10 cm, with four headings each."""


def models() -> list[bytes]:
    """Return two models: one that knows all cells and both kinds of readings, and one of every second cell."""
    return [_model(np.arange(60), len(INPUTS)), _model(np.arange(0, 60, 2), 1)]


def _model(cells: np.ndarray, inputs: int) -> bytes:
    likelihood = PoseLikelihood(GRID, cells, np.full(len(cells), 1.0 / len(cells)), 0.1)
    return small_model(likelihood, INPUTS[:inputs]).file_bytes()


def model_reader(place: Path) -> Read:
    """Read a model and the likelihood of poses inside and outside its grid, for a heat map that is even."""
    file = place / "model.npz"
    poses = np.array([[0.0, 0.0, 0.5], [0.13, -0.08, -3.0], [1e3, -1e3, 0.0]])

    def read(data: bytes) -> None:
        file.write_bytes(data)
        likelihood = read_model(file).likelihood
        likelihood.log_ratio(np.full(len(likelihood.cells), 1.0 / len(likelihood.cells)), poses)

    return read
