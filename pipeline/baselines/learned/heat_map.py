"""Heat maps over the poses in an arena, and the likelihood that follows from one.

A network that is trained on images with their poses estimates p(pose | reading). A filter needs p(reading | pose),
which by Bayes' rule is proportional to p(pose | reading) / p(pose), where p(pose) is the distribution of the training
poses. Without this division, a filter would prefer the places where the training robots were most often.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints, wrapped

SOFT_CELLS = 0.75
"""Standard deviation of the label of a pose, in cells of each axis: neighbours of the right cell are nearly right."""
MARGIN_CELLS = 3
"""Number of cells around the training poses."""
MIN_LABEL = 0.02
"""Largest share that the label of any training pose must have in a cell, so that the network has this cell."""
MIN_PRIOR_SHARE = 0.1
"""Share of the prior that is spread over all cells evenly, so that rare cells do not get a huge likelihood."""


@dataclass(frozen=True)
class PoseGrid:
    """Cells over x, y and heading."""

    x_m: float
    """x [m] of the middle of the first cell in W."""
    y_m: float
    cell_m: float
    """Side [m] of a cell."""
    columns: int
    """Number of cells along x."""
    rows: int
    """Number of cells along y."""
    headings: int
    """Number of cells around the full turn, the first one in the direction +x."""

    @classmethod
    def around(cls, pose: Array, cell_m: float, headings: int) -> "PoseGrid":
        """Return a grid that contains the poses (N, 3) with a margin."""
        low = np.floor(pose[:, :2].min(axis=0) / cell_m) - MARGIN_CELLS
        high = np.ceil(pose[:, :2].max(axis=0) / cell_m) + MARGIN_CELLS
        columns, rows = (high - low + 1).astype(int).tolist()
        return cls(float(low[0] * cell_m), float(low[1] * cell_m), cell_m, columns, rows, headings)

    @property
    def shape(self) -> tuple[int, int, int]:
        return self.columns, self.rows, self.headings

    @property
    def heading_step_rad(self) -> float:
        return 2.0 * np.pi / self.headings

    def place(self, pose: Array) -> Array:
        """Return the poses (N, 3) in cells, (N, 3): 0 is the middle of the first cell of an axis."""
        corner = np.array([self.x_m, self.y_m, 0.0])
        return (pose - corner) / np.array([self.cell_m, self.cell_m, self.heading_step_rad])

    def middles(self, cells: Ints) -> Array:
        """Return the poses (C, 3) in the middles of cells, by their numbers (C,)."""
        column, row, heading = np.unravel_index(cells, self.shape)
        yaw = wrapped(heading * self.heading_step_rad)
        return np.column_stack((self.x_m + column * self.cell_m, self.y_m + row * self.cell_m, yaw))

    def labels(self, pose: Array, cells: Ints) -> Array:
        """Return the soft label (N, C) of each pose (N, 3): a bell around it over the cells, with sum 1."""
        away = self.place(pose)[:, None] - np.stack(np.unravel_index(cells, self.shape), axis=1)
        away[..., 2] = (away[..., 2] + 0.5 * self.headings) % self.headings - 0.5 * self.headings
        log = -0.5 * (away**2).sum(axis=2) / SOFT_CELLS**2
        label = np.exp(log - log.max(axis=1, keepdims=True))
        return label / label.sum(axis=1, keepdims=True)

    def density(self, pose: Array, cells: Ints) -> Array:
        """Return the mean label (C,) of poses (N, 3), with sum 1."""
        blocks = np.array_split(pose, max(1, len(pose) // 64))
        return np.sum([self.labels(block, cells).sum(axis=0) for block in blocks], axis=0) / len(pose)

    def cells_near(self, pose: Array) -> Ints:
        """Return the numbers (C,) of the cells to which the label of one of the poses (N, 3) reaches, in order."""
        nearest = np.rint(self.place(pose)).astype(np.int64)
        around = np.array(list(product((-1, 0, 1), repeat=3)))
        near = (nearest[:, None] + around).reshape(-1, 3)
        near = near[np.all((near[:, :2] >= 0) & (near[:, :2] < self.shape[:2]), axis=1)]
        near[:, 2] %= self.headings
        candidates = np.unique(np.ravel_multi_index(tuple(near.T), self.shape))
        reach = np.zeros(len(candidates))
        for block in np.array_split(pose, max(1, len(pose) // 64)):
            reach = np.maximum(reach, self.labels(block, candidates).max(axis=0))
        return candidates[reach >= MIN_LABEL]

    def corners(self, pose: Array) -> tuple[Ints, Array]:
        """Return the eight cells around each pose (N, 3) and their weights for linear interpolation, (N, 8) each.

        The number of a cell outside of the grid is -1.
        """
        place = self.place(pose)
        low = np.floor(place)
        share = place - low
        numbers, weights = [], []
        for corner in product((0, 1), repeat=3):
            cell = (low + corner).astype(np.int64)
            inside = np.all((cell[:, :2] >= 0) & (cell[:, :2] < self.shape[:2]), axis=1)
            cell[:, 2] %= self.headings
            numbers.append(np.where(inside, np.ravel_multi_index(tuple(np.where(inside, cell.T, 0)), self.shape), -1))
            weights.append(np.where(corner, share, 1.0 - share).prod(axis=1))
        return np.column_stack(numbers), np.column_stack(weights)


@dataclass(frozen=True)
class PoseLikelihood:
    """The likelihood of a pose by the heat map of a reading, relative to that of a reading which shows nothing."""

    grid: PoseGrid
    cells: Ints
    """(C,), numbers of the cells to which training poses reached; the network knows only these."""
    prior: Array
    """(C,), share of the training poses in each of these cells, with sum 1."""
    wrong: float
    """Share of the readings by which the network errs, as on a straight line that looks like another one."""

    def log_ratio(self, heat: Array, pose: Array) -> Array:
        """Return the logarithm (P,) of p(reading | pose) / p(reading).

        With the probability `wrong` the heat map says nothing, so the ratio is `wrong + (1 - wrong) heat / prior`.

        Args:
            heat: Probability of each cell, (C,), with sum 1.
            pose: Poses, (P, 3).
        """
        return np.log1p((1.0 - self.wrong) * self.excess(heat, pose))

    def excess(self, heat: Array, pose: Array) -> Array:
        """Return `heat / prior - 1` at the poses (P, 3), interpolated between the cells.

        It is 0 outside the cells: the network has seen nothing there.
        """
        excess = np.append(heat / self._smoothed_prior - 1.0, 0.0)
        numbers, weights = self.grid.corners(pose)
        return (excess[self._index[numbers]] * weights).sum(axis=1)

    @cached_property
    def _smoothed_prior(self) -> Array:
        return (1.0 - MIN_PRIOR_SHARE) * self.prior + MIN_PRIOR_SHARE / len(self.prior)

    @cached_property
    def _index(self) -> Ints:
        """Index in `cells` of each cell of the grid, and at the end that of no cell; -1 where there is none."""
        index = np.full(int(np.prod(self.grid.shape)) + 1, -1)
        index[self.cells] = np.arange(len(self.cells))
        return index
