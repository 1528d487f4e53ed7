"""Statistics of features for each episode and for all together, as in LeRobot, which normalises inputs with them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from symolo.reader.run_folder import Pixels

_QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)
_LEVELS = 256
Stats = dict[str, list]
"""Values by name: min, max, mean, std, q01..q99 of each component, and the count of frames."""


def vector_stats(values: np.ndarray) -> Stats:
    """Return the statistics of values (N,) or (N, components)."""
    table = values.reshape(len(values), -1).astype(np.float64)
    stats = {"min": table.min(0), "max": table.max(0), "mean": table.mean(0), "std": table.std(0)}
    stats |= {_name(share): np.quantile(table, share, axis=0) for share in _QUANTILES}
    return {name: one.tolist() for name, one in stats.items()} | {"count": [len(table)]}


@dataclass(frozen=True)
class Levels:
    """Number of pixels with each level of each channel in some images; this determines all statistics exactly."""

    images: int
    counts: np.ndarray
    """(3, 256), number of pixels; red, green, blue."""

    @classmethod
    def from_images(cls, images: Iterable[Pixels]) -> "Levels":
        counts = [[np.bincount(image[..., i].ravel(), minlength=_LEVELS) for i in range(3)] for image in images]
        return cls(len(counts), np.sum(counts, axis=0))

    def __add__(self, other: "Levels") -> "Levels":
        return Levels(self.images + other.images, self.counts + other.counts)

    def stats(self) -> Stats:
        """Return the statistics of the channels, from 0 to 1, in the shape (3, 1, 1)."""
        level = np.arange(_LEVELS) / (_LEVELS - 1)
        share = self.counts / self.counts.sum(axis=1, keepdims=True)
        mean = share @ level
        occurs = self.counts > 0
        stats = {
            "min": level[occurs.argmax(axis=1)],
            "max": level[_LEVELS - 1 - occurs[:, ::-1].argmax(axis=1)],
            "mean": mean,
            "std": np.sqrt((share * (level - mean[:, None]) ** 2).sum(axis=1)),
        }
        reached = self.counts.cumsum(axis=1)
        for part in _QUANTILES:
            stats[_name(part)] = level[(reached >= part * reached[:, -1:]).argmax(axis=1)]
        return {name: one.reshape(3, 1, 1).tolist() for name, one in stats.items()} | {"count": [self.images]}


def _name(share: float) -> str:
    return f"q{round(100 * share):02d}"
