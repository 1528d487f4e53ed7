"""The pose of an image from similar images of other runs: retrieval, then kernel regression.

An image is described by the directions of its edges, cell by cell, without their signs and strengths (Dalal and Triggs,
"Histograms of oriented gradients for human detection", CVPR 2005), because light, floor and walls differ between runs.
Images are compared by the principal components of these descriptions, whitened half-way. The estimated pose is the mean
over the training images, weighted by similarity (Nadaraya and Watson, 1964). Its covariance is that of the weighted
poses, plus a share of the covariance of all poses, because some images are confused with those of another place that
looks alike. The width of the weights and that share are determined by leaving out one training run after the other.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import root_scalar

from pipeline.baselines.base import NO_IMAGES, Method, TrainingRun
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import Ints, wrapped
from symolo.evaluation.errors import nees, pose_errors
from symolo.evaluation.estimate import Estimate

CELL_PX = 4
DIRECTIONS = 6
FAINT = 0.01
"""Contrast of an edge below which it counts little."""
COMPONENTS = 60
WHITENING = 0.5
WIDTHS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8)
"""Widths of the weights that are tried, as shares of the distance to the most similar image."""
PARTS = 4
"""Number of parts of a single training run, each left out in turn."""
MIN_SD = np.array([0.01, 0.01, 0.02])
"""Smallest standard deviation of the estimate: neighbouring images are 3 cm apart."""


def edge_directions(grey: Array) -> Array:
    """Return features (M, F) of images (M, h, w): the root of the share of each direction in each cell."""
    down, right = np.gradient(grey, axis=(1, 2))
    strength = np.hypot(right, down)
    direction = np.arctan2(down, right) % np.pi * (DIRECTIONS / np.pi)
    planes = []
    for number in range(DIRECTIONS):
        # Distance in bins, around the half turn; an edge between two directions counts for both.
        away = np.abs((direction - number + 0.5 * DIRECTIONS) % DIRECTIONS - 0.5 * DIRECTIONS)
        planes.append(strength * np.maximum(1.0 - away, 0.0))
    spread = gaussian_filter(np.array(planes), (0, 0, 0.5 * CELL_PX, 0.5 * CELL_PX))
    cells = spread[:, :, CELL_PX // 2 :: CELL_PX, CELL_PX // 2 :: CELL_PX]
    shares = cells / np.sqrt((cells**2).sum(axis=0) + FAINT**2)
    return np.sqrt(shares).transpose(1, 0, 2, 3).reshape(len(grey), -1)


class _Regressor:
    def __init__(self, training_runs: Sequence[TrainingRun]) -> None:
        features = np.concatenate([edge_directions(training_run.images.thumbnails) for training_run in training_runs])
        self._mean = features.mean(axis=0)
        _, size, axes = np.linalg.svd(features - self._mean, full_matrices=False)
        size, axes = size[:COMPONENTS], axes[:COMPONENTS]
        self._to_components = axes.T / np.maximum(size, 1e-9) ** WHITENING
        self._training = (features - self._mean) @ self._to_components
        self._pose = np.concatenate([training_run.pose for training_run in training_runs])
        self._all = _weighted(np.zeros((1, len(self._pose))), self._pose, 1.0)[1][0]
        self._width, self._share = self._tuned(_folds([len(training_run.pose) for training_run in training_runs]))

    def estimate(self, grey: Array) -> tuple[Array, Array]:
        """Return poses (M, 3) and covariances (M, 3, 3) of images (M, h, w)."""
        query = (edge_directions(grey) - self._mean) @ self._to_components
        pose, covariance = _weighted(_distances(query, self._training), self._pose, self._width)
        return pose, covariance + self._share * self._all

    def _tuned(self, folds: Sequence[Ints]) -> tuple[float, float]:
        """Return the width with the smallest median error in left-out images, and the share of outliers among them."""
        if not folds:
            return WIDTHS[0], 1.0
        candidates = []
        for width in WIDTHS:
            estimates = []
            for out in folds:
                others = np.setdiff1d(np.arange(len(self._pose)), out)
                distances = _distances(self._training[out], self._training[others])
                estimates.append(Estimate(out, *_weighted(distances, self._pose[others], width)))
            median_m = np.median(np.concatenate([pose_errors(estimate, self._pose)[0] for estimate in estimates]))
            candidates.append((float(median_m), width, estimates))
        _, width, estimates = min(candidates, key=lambda candidate: candidate[:2])
        return width, self._outlier_share(estimates)

    def _outlier_share(self, estimates: Sequence[Estimate]) -> float:
        """Return the share of outliers with which the mean NEES is 3, that of consistent estimates."""

        def excess_nees(share: float) -> float:
            wider = (replace(each, covariance=each.covariance + share * self._all) for each in estimates)
            return float(np.concatenate([nees(estimate, self._pose) for estimate in wider]).mean()) - 3.0

        if excess_nees(1.0) >= 0.0:
            return 1.0
        return float(root_scalar(excess_nees, bracket=(0.0, 1.0), xtol=1e-3).root) if excess_nees(0.0) > 0.0 else 0.0


def _weighted(distances: Array, training: Array, width: float) -> tuple[Array, Array]:
    """Return mean poses (M, 3) and covariances (M, 3, 3) of training poses (T, 3), by squared distances (M, T)."""
    nearest = distances.min(axis=1, keepdims=True)
    weight = np.exp(-0.5 * (distances / np.maximum(nearest, 1e-12) - 1.0) / width**2)
    weight /= weight.sum(axis=1, keepdims=True)
    yaw = np.arctan2(weight @ np.sin(training[:, 2]), weight @ np.cos(training[:, 2]))
    pose = np.column_stack((weight @ training[:, :2], yaw))
    away = training[None] - pose[:, None]
    away[..., 2] = wrapped(away[..., 2])
    covariance = np.einsum("mt,mti,mtj->mij", weight, away, away, optimize=True)
    return pose, covariance + np.diag(MIN_SD**2)


def _distances(query: Array, training: Array) -> Array:
    """Return the squared distances (M, T)."""
    squares = (query**2).sum(axis=1)[:, None] - 2.0 * query @ training.T + (training**2).sum(axis=1)
    return np.maximum(squares, 0.0)


def _folds(counts: Sequence[int]) -> list[Ints]:
    """Return the images that are left out together: those of a run, or of a part of a single run; none for a single
    image.
    """
    rows = np.arange(sum(counts))
    parts = np.array_split(rows, PARTS) if len(counts) == 1 else np.split(rows, np.cumsum(counts)[:-1])
    return [part for part in parts if 0 < len(part) < len(rows)]


def _estimate(knowledge: RobotKnowledge, training_runs: Sequence[TrainingRun], _rng: np.random.Generator) -> Estimate:
    if knowledge.images is None:
        raise InputError(NO_IMAGES)
    pose, covariance = _Regressor(training_runs).estimate(knowledge.images.thumbnails)
    return Estimate(knowledge.images.rows.copy(), pose, covariance)


METHOD = Method(
    "retrieval", "image retrieval", "one image, compared with those of the other runs", _estimate, learns=True
)
