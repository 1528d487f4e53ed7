"""A model from the runs of a release: which runs train it, and which decide when to stop."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.baselines.base import NO_IMAGES
from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from pipeline.baselines.learned.model import (
    Input,
    LocalisationModel,
    ModelDescription,
    run_fingerprint,
)
from pipeline.baselines.learned.readings import NetworkReadings, check_shape, knowledge_of
from pipeline.baselines.learned.torch_side.network import pytorch
from pipeline.baselines.learned.torch_side.training import Samples, TrainedNetwork, train
from pipeline.baselines.runs import LoggedRun
from symolo.arena.fingerprint import arena_fingerprint
from symolo.core.errors import InputError
from symolo.core.progress import Report
from symolo.core.random_streams import stream
from symolo.core.versions import versions

CELL_M = 0.04
HEADINGS = 36
VALIDATION_SHARE = 0.2
"""Share of the runs that are set aside for validation."""


@dataclass(frozen=True)
class Training:
    """A trained model with the runs that trained and validated it."""

    model: LocalisationModel
    network: TrainedNetwork
    training: tuple[str, ...]
    """Names of the runs that trained the network."""
    validation: tuple[str, ...]
    """Names of the runs that were set aside."""
    training_images: int
    validation_images: int


def check_trainable(runs: Sequence[LoggedRun]) -> None:
    """Refuse runs from which no model can be trained, before work starts.

    Raises:
        InputError: There is one run only, a run without images, or more than one arena.
        EnvironmentLacking: PyTorch is not installed.
    """
    if len(runs) == 1:
        raise InputError("there is one run only: training needs one, and validation another", where=runs[0].name)
    for run in runs:
        if run.images is None:
            raise InputError(NO_IMAGES, where=run.name)
        check_shape(run.images.pixels(0).shape, run.name)
    arenas = {arena_fingerprint(knowledge_of(run).map) for run in runs}
    if len(arenas) > 1:
        what = f"the runs have {len(arenas)} arenas: a model is of one arena"
        raise InputError(what, cure="choose runs of one arena with --runs")
    pytorch()


def trained(
    runs: Sequence[LoggedRun], inputs: Sequence[Input], *, max_epochs: int, seed: int, report: Report
) -> Training:
    """Return a model that is trained on four fifths of the runs, and stopped by the others."""
    aside = validation_runs(len(runs), seed)
    read: list[Samples] = []
    with report.stage("read", len(runs), "runs") as stage:
        for run in runs:
            read.append(_samples(run))
            stage.update("all", len(read))
    training, validation = (
        _joined([samples for index, samples in enumerate(read) if (index in aside) == for_validation])
        for for_validation in (False, True)
    )
    grid = PoseGrid.around(training.pose, CELL_M, HEADINGS)
    cells = grid.cells_near(training.pose)
    with report.stage("train", max_epochs, "epochs") as stage:
        network = train(training, validation, inputs, grid, cells, max_epochs=max_epochs, seed=seed, stage=stage)
    about = ModelDescription(
        arena=arena_fingerprint(knowledge_of(runs[0]).map),
        inputs=tuple(inputs),
        x_m=grid.x_m,
        y_m=grid.y_m,
        cell_m=grid.cell_m,
        columns=grid.columns,
        rows=grid.rows,
        headings=grid.headings,
        temperature=network.temperature,
        wrong=network.wrong,
        seed=seed,
        training_runs=tuple(run_fingerprint(run.spec) for index, run in enumerate(runs) if index not in aside),
        validation_runs=tuple(run_fingerprint(run.spec) for index, run in enumerate(runs) if index in aside),
        epochs=network.epochs,
        made_with=versions("symolo", "numpy", "torch"),
    )
    likelihood = PoseLikelihood(grid, cells, network.prior, network.wrong)
    return Training(
        LocalisationModel(about, likelihood, network.weights),
        network,
        tuple(run.name for index, run in enumerate(runs) if index not in aside),
        tuple(run.name for index, run in enumerate(runs) if index in aside),
        len(training.pose),
        len(validation.pose),
    )


def validation_runs(count: int, seed: int) -> frozenset[int]:
    """Return the numbers of the runs that are set aside: a fifth of them, at least one, at random."""
    aside = max(1, round(VALIDATION_SHARE * count))
    return frozenset(stream(seed, "validation").permutation(count)[:aside].tolist())


def _samples(run: LoggedRun) -> Samples:
    readings = NetworkReadings.from_knowledge(knowledge_of(run))
    assert run.images is not None  # noqa: S101 - `check_trainable` has looked
    return Samples(readings, run.truth[run.images.rows])


def _joined(parts: Sequence[Samples]) -> Samples:
    grey = np.concatenate([part.readings.grey for part in parts])
    ranges = np.concatenate([part.readings.ranges for part in parts])
    return Samples(NetworkReadings(grey, ranges), np.concatenate([part.pose for part in parts]))
