"""Training of the network: soft labels, random changes of the readings, and runs set aside that decide when to stop."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.baselines.learned.augmentation import augmented
from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from pipeline.baselines.learned.model import Input
from pipeline.baselines.learned.readings import NetworkReadings
from pipeline.baselines.learned.torch_side.network import BATCH, PoseNetwork, one_thread, pytorch, scores_of, softmax
from symolo.core.arrays import Array
from symolo.core.progress import StageReport
from symolo.core.random_streams import stream
from symolo.dataset.tables.rows import Ints

RATE, WEIGHT_DECAY = 2e-3, 1e-3
PATIENCE = 15
"""Number of epochs without progress on the runs for validation, after which training ends."""
TEMPERATURES = np.geomspace(0.5, 4.0, 25)
WRONG = np.geomspace(0.005, 0.6, 25)


@dataclass(frozen=True)
class Samples:
    """M readings with the true poses, for training or validation."""

    readings: NetworkReadings
    pose: Array
    """(M, 3), true poses at the readings."""


@dataclass(frozen=True)
class TrainedNetwork:
    """The result of a training: the weights that were best in the validation runs, and numbers fitted to these runs."""

    weights: dict[str, Array]
    """Parameters of the network by name."""
    prior: Array
    """(C,), share of the training poses in each cell."""
    temperature: float
    """Divisor of the network's outputs, fitted to the runs for validation."""
    wrong: float
    """Share of the readings by which the network errs, fitted to the same runs."""
    epochs: int
    """Number of epochs after which the weights were kept."""
    median_m: float
    """Median distance [m] of the most likely cell from the true place, in the runs for validation."""


def train(
    training: Samples,
    validation: Samples,
    inputs: Sequence[Input],
    grid: PoseGrid,
    cells: Ints,
    *,
    max_epochs: int,
    seed: int,
    stage: StageReport,
) -> TrainedNetwork:
    """Train a network, and fit temperature and share of errors to the validation runs.

    The weights that are kept are those with the smallest cross entropy in the validation runs. The same samples and
    seed give the same weights on the same kind of machine with the same version of PyTorch.
    """
    torch = pytorch()
    rng = stream(seed, "training")
    with torch.random.fork_rng(devices=[]), one_thread():
        torch.manual_seed(int(rng.integers(2**31)))
        network = PoseNetwork(inputs, len(cells))
        optimizer = torch.optim.AdamW(network.modules.parameters(), lr=RATE, weight_decay=WEIGHT_DECAY)
        steps = max_epochs * -(-len(training.pose) // BATCH)
        schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=steps, pct_start=0.1)
        best, best_loss, best_epoch = network.weights(), np.inf, 1
        for epoch in range(1, max_epochs + 1):
            network.modules.train()
            order = rng.permutation(len(training.pose))
            for rows in np.array_split(order, max(1, -(-len(order) // BATCH))):
                labels = grid.labels(training.pose[rows], cells)
                scores = network.scores(augmented(training.readings, rows, rng))
                loss = torch.nn.functional.cross_entropy(scores, torch.from_numpy(labels.astype(np.float32)))
                optimizer.zero_grad()
                loss.backward()
                optimizer.step()
                schedule.step()
            aside = _cross_entropy(scores_of(network, validation.readings), grid, validation.pose, cells)
            if aside < best_loss:
                best, best_loss, best_epoch = network.weights(), aside, epoch
            stage.update("all", epoch)
            if epoch - best_epoch >= PATIENCE:
                stage.say(f"no progress for {PATIENCE} epochs")
                break
        network.load(best)
        scores = scores_of(network, validation.readings)
    prior = grid.density(training.pose, cells)
    temperature, wrong = calibrated(scores, PoseLikelihood(grid, cells, prior, 0.5), validation.pose)
    likely = grid.middles(cells[scores.argmax(axis=1)])
    median_m = float(np.median(np.hypot(*(likely - validation.pose)[:, :2].T)))
    return TrainedNetwork(best, prior, temperature, wrong, best_epoch, median_m)


def calibrated(scores: Array, likelihood: PoseLikelihood, pose: Array) -> tuple[float, float]:
    """Return the temperature and the share of errors with the largest likelihood of the true poses (M, 3)."""
    choices = []
    for temperature in TEMPERATURES:
        heat = softmax(scores / temperature)
        excess = np.array([likelihood.excess(each, at[None])[0] for each, at in zip(heat, pose, strict=True)])
        choices += [(float(np.log1p((1.0 - w) * excess).sum()), float(temperature), float(w)) for w in WRONG]
    _, temperature, wrong = max(choices)
    return temperature, wrong


def _cross_entropy(scores: Array, grid: PoseGrid, pose: Array, cells: Ints) -> float:
    """Return the mean cross entropy between soft labels and heat maps, by scores (M, C)."""
    total = 0.0
    for rows in np.array_split(np.arange(len(pose)), max(1, len(pose) // BATCH)):
        heat = softmax(scores[rows])
        total -= float((grid.labels(pose[rows], cells) * np.log(np.maximum(heat, 1e-12))).sum())
    return total / len(pose)
