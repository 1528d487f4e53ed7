"""The network: convolutions over the image, two layers over the ranges, and a score for each cell of the heat map."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import numpy as np

from pipeline.baselines.learned.model import Input, LocalisationModel
from pipeline.baselines.learned.readings import RANGE_NUMBERS, NetworkReadings
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.extras import optional_module

CHANNELS = (24, 48, 64, 96)
IMAGE_FEATURES, RANGE_FEATURES, HIDDEN = 160, 48, 192
AROUND_PX = 15
"""Side [px] of the square around a pixel, in which brightness and contrast are compared."""
FAINT = 0.03
"""Contrast, of a range from 0 to 1, below which a difference counts little."""
DROPPED = 0.2
"""Share of the features that are left out in each step of training."""
BATCH = 64
Tensor = Any
"""A tensor of PyTorch, whose types are not at hand where it is not installed."""


def pytorch() -> ModuleType:
    """Return PyTorch.

    Raises:
        EnvironmentLacking: The extra `learn` is not installed.
    """
    return optional_module("torch")


class PoseNetwork:
    """Parts of the network, each a plain sequence of layers."""

    def __init__(self, inputs: Sequence[Input], cells: int) -> None:
        torch = pytorch()
        nn = torch.nn
        parts = {}
        features = 0
        if "images" in inputs:
            layers, before = [], 1
            for channels in CHANNELS:
                size, padding = (5, 2) if before == 1 else (3, 1)
                layers += [nn.Conv2d(before, channels, size, 2, padding), nn.BatchNorm2d(channels), nn.ReLU()]
                before = channels
            # 48 x 64 px, halved four times
            flat = before * 3 * 4
            parts["image"] = nn.Sequential(
                *layers, nn.Flatten(), nn.Dropout(DROPPED), nn.Linear(flat, IMAGE_FEATURES), nn.ReLU()
            )
            features += IMAGE_FEATURES
        if "ranges" in inputs:
            first, second = nn.Linear(RANGE_NUMBERS, RANGE_FEATURES), nn.Linear(RANGE_FEATURES, RANGE_FEATURES)
            parts["ranges"] = nn.Sequential(first, nn.ReLU(), second, nn.ReLU())
            features += RANGE_FEATURES
        head = [nn.Linear(features, HIDDEN), nn.ReLU(), nn.Dropout(DROPPED), nn.Linear(HIDDEN, cells)]
        parts["head"] = nn.Sequential(*head)
        self.modules = nn.ModuleDict(parts)

    def scores(self, readings: NetworkReadings) -> Tensor:
        """Return the score (B, C) of each cell; the softmax over the cells is the heat map."""
        torch = pytorch()
        features = []
        if "image" in self.modules:
            features.append(self.modules["image"](_normalised(readings.grey)))
        if "ranges" in self.modules:
            features.append(self.modules["ranges"](torch.from_numpy(readings.ranges.astype(np.float32))))
        return self.modules["head"](torch.cat(features, dim=1))

    def weights(self) -> dict[str, Array]:
        """Return copies of all parameters, (N,) or (N, K), for a model file."""
        state = self.modules.state_dict()
        return {name: _flat(tensor.detach().cpu().numpy().copy()) for name, tensor in state.items()}

    def load(self, weights: Mapping[str, Array]) -> None:
        """Set all parameters.

        Raises:
            InputError: Names or shapes are not those of this network.
        """
        torch = pytorch()
        state = self.modules.state_dict()
        shapes = {name: _flat(tensor.numpy()).shape for name, tensor in state.items()}
        if shapes != {name: values.shape for name, values in weights.items()}:
            raise InputError("the model has weights of another network", cure="train it again with `symolo train`")
        self.modules.load_state_dict(
            {
                name: torch.from_numpy(np.array(weights[name])).to(tensor.dtype).reshape(tensor.shape)
                for name, tensor in state.items()
            }
        )


def heat_maps(model: LocalisationModel, readings: NetworkReadings) -> Array:
    """Return the heat map (M, C) of each of the readings: the probability of each cell, with sum 1."""
    network = PoseNetwork(model.about.inputs, len(model.likelihood.cells))
    network.load(model.weights)
    return softmax(scores_of(network, readings) / model.about.temperature)


def scores_of(network: PoseNetwork, readings: NetworkReadings) -> Array:
    """Return the scores (M, C) without gradients and without the randomness of training."""
    torch = pytorch()
    network.modules.eval()
    scores = []
    with torch.no_grad(), one_thread():
        for rows in np.array_split(np.arange(len(readings)), max(1, -(-len(readings) // BATCH))):
            part = NetworkReadings(readings.grey[rows], readings.ranges[rows])
            scores.append(network.scores(part).numpy().astype(float))
    return np.concatenate(scores)


def softmax(scores: Array) -> Array:
    """Return probabilities (M, C) with sum 1 from scores (M, C)."""
    probability = np.exp(scores - scores.max(axis=1, keepdims=True))
    return probability / probability.sum(axis=1, keepdims=True)


@contextmanager
def one_thread() -> Iterator[None]:
    """Compute on one thread and with deterministic operations, so that the same numbers come out again."""
    torch = pytorch()
    threads, deterministic = torch.get_num_threads(), torch.are_deterministic_algorithms_enabled()
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(mode=True)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
        torch.use_deterministic_algorithms(mode=deterministic)


def _normalised(grey: Array) -> Tensor:
    """Return images (B, 1, h, w) with mean 0 and standard deviation 1 around each pixel, for light differs by look."""
    torch = pytorch()
    image = torch.from_numpy(grey.astype(np.float32))[:, None]
    pool = torch.nn.AvgPool2d(AROUND_PX, 1, AROUND_PX // 2, count_include_pad=False)
    away = image - pool(image)
    return away / (pool(away**2).sqrt() + FAINT)


def _flat(values: Array) -> Array:
    """Return an array (N,) or (N, K), as a model file can hold."""
    return (
        values.reshape(values.shape[0], -1) if values.ndim > 2 else values.reshape(-1) if values.ndim == 0 else values
    )
