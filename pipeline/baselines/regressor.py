"""The pose of an image from similar images of other runs: retrieval, then kernel regression.

A picture becomes the directions of its edges, cell by cell, without their signs and strengths (Dalal and Triggs,
"Histograms of oriented gradients for human detection", CVPR 2005), for light, floor and walls are others in every
run. By the principal components of those, whitened half-way, images are compared. The estimated pose is the mean over
the training pictures, weighted by likeness (Nadaraya and Watson, 1964). Its covariance is theirs, and some of that of
all poses, for a share of the pictures is taken for one of quite another place that looks alike. How narrow the
weights are, and how large that share is, is determined by leaving out one training run after the other.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import root_scalar

from pipeline.baselines.base import Estimate, Method, TrainingRun
from pipeline.baselines.errors import nees, off
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import Ints, wrapped

CELL_PX = 4
DIRECTIONS = 6
FAINT = 0.01
"""Edges below this contrast count little."""
COMPONENTS = 60
WHITENING = 0.5
WIDTHS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8)
"""Widths that are tried, of the weights: in shares of the distance to the likest picture."""
PARTS = 4
"""Number of parts of a single training run, each left out in turn."""
MIN_SD = np.array([0.01, 0.01, 0.02])
"""Smallest standard deviation of the estimate: neighbouring images are 3 cm apart."""


def edge_directions(grey: Array) -> Array:
    """Features (M, F) of pictures (M, h, w): root of the share of each direction in each cell."""
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
    def __init__(self, lessons: Sequence[TrainingRun]) -> None:
        features = np.concatenate([edge_directions(lesson.pictures.thumbnails) for lesson in lessons])
        self._mean = features.mean(axis=0)
        _, size, axes = np.linalg.svd(features - self._mean, full_matrices=False)
        size, axes = size[:COMPONENTS], axes[:COMPONENTS]
        self._to_components = axes.T / np.maximum(size, 1e-9) ** WHITENING
        self._training = (features - self._mean) @ self._to_components
        self._pose = np.concatenate([lesson.pose for lesson in lessons])
        self._all = _weighted(np.zeros((1, len(self._pose))), self._pose, 1.0)[1][0]
        self._width, self._share = self._judged(_folds([len(lesson.pose) for lesson in lessons]))

    def tell(self, grey: Array) -> tuple[Array, Array]:
        """Poses (M, 3) and covariances (M, 3, 3) of pictures (M, h, w)."""
        query = (edge_directions(grey) - self._mean) @ self._to_components
        pose, covariance = _weighted(_distances(query, self._training), self._pose, self._width)
        return pose, covariance + self._share * self._all

    def _judged(self, folds: Sequence[Ints]) -> tuple[float, float]:
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
            median_m = np.median(np.concatenate([off(one, self._pose)[0] for one in estimates]))
            candidates.append((float(median_m), width, estimates))
        _, width, estimates = min(candidates, key=lambda one: one[:2])
        return width, self._elsewhere(estimates)

    def _elsewhere(self, estimates: Sequence[Estimate]) -> float:
        """Return the share of outliers with which the mean NEES is that of honest estimates."""

        def too_sure(share: float) -> float:
            wider = (replace(one, covariance=one.covariance + share * self._all) for one in estimates)
            return float(np.concatenate([nees(one, self._pose) for one in wider]).mean()) - 3.0

        if too_sure(1.0) >= 0.0:
            return 1.0
        return float(root_scalar(too_sure, bracket=(0.0, 1.0), xtol=1e-3).root) if too_sure(0.0) > 0.0 else 0.0


def _weighted(distances: Array, training: Array, width: float) -> tuple[Array, Array]:
    """Mean poses (M, 3) and covariances (M, 3, 3) of training poses (T, 3), by squared distances (M, T)."""
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
    """(M, T), squared."""
    squares = (query**2).sum(axis=1)[:, None] - 2.0 * query @ training.T + (training**2).sum(axis=1)
    return np.maximum(squares, 0.0)


def _folds(counts: Sequence[int]) -> list[Ints]:
    """Return the images that are left out together: those of a run, or of a part of a single run; none for a single
    image.
    """
    rows = np.arange(sum(counts))
    parts = np.array_split(rows, PARTS) if len(counts) == 1 else np.split(rows, np.cumsum(counts)[:-1])
    return [part for part in parts if 0 < len(part) < len(rows)]


def _estimate(knowledge: RobotKnowledge, lessons: Sequence[TrainingRun], _rng: np.random.Generator) -> Estimate:
    if knowledge.pictures is None:
        raise InputError("the run has no pictures", cure="release its scenario in place of simulating it")
    pose, covariance = _Regressor(lessons).tell(knowledge.pictures.thumbnails)
    return Estimate(knowledge.pictures.rows.copy(), pose, covariance)


METHOD = Method("pictures", "picture regressor", "one picture, beside those of the other runs", _estimate, learns=True)
