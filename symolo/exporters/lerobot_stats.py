"""Statistics of features as LeRobot stores them for each episode and for all: what policies are normalised by."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from symolo.reader.run import Pixels

_QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)
_LEVELS = 256
Stats = dict[str, list]
"""By name: min, max, mean, std, q01..q99 of each component, and count of the frames."""


def vector_stats(values: np.ndarray) -> Stats:
    """Of values (N,) or (N, components)."""
    table = values.reshape(len(values), -1).astype(np.float64)
    found = {"min": table.min(0), "max": table.max(0), "mean": table.mean(0), "std": table.std(0)}
    found |= {_name(share): np.quantile(table, share, axis=0) for share in _QUANTILES}
    return {name: one.tolist() for name, one in found.items()} | {"count": [len(table)]}


@dataclass(frozen=True)
class Levels:
    """How often each level of each channel occurs in some pictures, of which everything else follows exactly."""

    pictures: int
    counts: np.ndarray
    """(3, 256), red, green, blue."""

    @classmethod
    def of(cls, pictures: Iterable[Pixels]) -> "Levels":
        found = [[np.bincount(one[..., i].ravel(), minlength=_LEVELS) for i in range(3)] for one in pictures]
        return cls(len(found), np.sum(found, axis=0))

    def __add__(self, other: "Levels") -> "Levels":
        return Levels(self.pictures + other.pictures, self.counts + other.counts)

    def stats(self) -> Stats:
        """Of channels, in 0..1, each as (1, 1) for the picture's rows and columns."""
        level = np.arange(_LEVELS) / (_LEVELS - 1)
        share = self.counts / self.counts.sum(axis=1, keepdims=True)
        mean = share @ level
        met = self.counts > 0
        found = {
            "min": level[met.argmax(axis=1)],
            "max": level[_LEVELS - 1 - met[:, ::-1].argmax(axis=1)],
            "mean": mean,
            "std": np.sqrt((share * (level - mean[:, None]) ** 2).sum(axis=1)),
        }
        reached = self.counts.cumsum(axis=1)
        for part in _QUANTILES:
            found[_name(part)] = level[(reached >= part * reached[:, -1:]).argmax(axis=1)]
        return {name: one.reshape(3, 1, 1).tolist() for name, one in found.items()} | {"count": [self.pictures]}


def _name(share: float) -> str:
    return f"q{round(100 * share):02d}"
