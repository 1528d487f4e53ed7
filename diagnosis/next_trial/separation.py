"""Separation of rival models by a trial, and the precision of their parameters, in closed form.

A trial consists of units, such as the rows of a bench or the runs of a log, each of which is chosen from a list. With
the model A as the truth, the separation from its rival B is the root of the smallest weighted sum of squares between
what A predicts and what B predicts with all its parameters fitted again to the old and the new data (T-optimality:
Atkinson and Fedorov, Biometrika 62 (1975) 57-70). Near the fit to the old data, B is linear in its parameters, and the
old data enter by their information. So the separation follows from sums over the units, and adding a unit costs no fit.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

RIDGE = 1e-9
"""Share of the diagonal that is added to an information matrix, so that it can be solved where the data do not
determine a parameter."""


@dataclass(frozen=True, eq=False)
class ModelOfUnits:
    """Predictions of N samples of U units by one model with P parameters, in standard deviations of their noise."""

    mean: Array
    """(N,), predictions of the readings in standard deviations."""
    slopes: Array
    """(P, N), derivatives of the predictions by the parameters."""
    before: Array
    """(P, P), information of the old data and of the tolerances about the parameters."""
    weight: float
    """Weight of the model among all models; the weights have the sum 1."""
    is_effect: NDArray[np.bool_]
    """(P,), parameters of effects; the others are nominal parameters."""


@dataclass(frozen=True, eq=False)
class Sums:
    """Sums over the units of several trials, (..., ) each; `pairs` are the ordered pairs of different models."""

    information: tuple[Array, ...]
    """(..., P, P), information of the trial about the parameters of each model."""
    squares: tuple[Array, ...]
    """(...), sum of the squared differences between the two models of each pair."""
    products: tuple[Array, ...]
    """(..., P), sum of the differences of each pair times the slopes of the rival."""

    def plus(self, other: "Sums", sign: float = 1.0) -> "Sums":
        """Return the sums of both, or the difference with a sign of -1."""
        parts = (
            tuple(a + sign * b for a, b in zip(mine, others, strict=True))
            for mine, others in (
                (self.information, other.information),
                (self.squares, other.squares),
                (self.products, other.products),
            )
        )
        return Sums(*parts)

    def for_units(self, units: NDArray[np.int64]) -> "Sums":
        """Return the values of some units from those of all units."""
        return Sums(*(tuple(each[units] for each in part) for part in (self.information, self.squares, self.products)))

    def total(self) -> "Sums":
        """Return the sums over all units."""
        return Sums(
            *(tuple(each.sum(axis=0) for each in part) for part in (self.information, self.squares, self.products))
        )


class UnitStatistics:
    """What each unit contributes to the separation of all pairs of models and to the precision of each."""

    def __init__(
        self, models: Sequence[ModelOfUnits], unit: NDArray[np.int64], units: int, cap: float = np.inf
    ) -> None:
        """Take the models.

        Args:
            models: At least one model.
            unit: (N,), unit of each sample.
            units: Number of units.
            cap: Difference of two models in standard deviations that a sample is worth at most. A unit with larger
                ones has less weight, since a fit takes a few readings that are far off for outliers.
        """
        self.models = tuple(models)
        count = range(len(models))
        self.pairs = tuple((a, b) for a in count for b in count if a != b)
        """Ordered pairs: the truth and its rival."""
        self._solvable = tuple(model.before + np.diag(RIDGE * np.diag(model.before) + 1e-12) for model in models)
        order = np.argsort(unit, kind="stable")
        starts = np.searchsorted(unit[order], np.arange(units))

        def by_unit(samples: Array) -> Array:
            return np.add.reduceat(samples[order], starts, axis=0)

        squares = [by_unit((models[a].mean - models[b].mean) ** 2) for a, b in self.pairs]
        samples = np.bincount(unit, minlength=units)
        weight = 1.0 / (1.0 + np.max([each / samples for each in squares], axis=0, initial=0.0) / cap**2)
        if not squares:
            weight = np.ones(units)
        self.of_units = Sums(
            tuple(
                weight[:, None, None] * by_unit(model.slopes.T[:, :, None] * model.slopes.T[:, None, :])
                for model in models
            ),
            tuple(weight * each for each in squares),
            tuple(
                weight[:, None] * by_unit((models[a].mean - models[b].mean)[:, None] * models[b].slopes.T)
                for a, b in self.pairs
            ),
        )

    def separations(self, sums: Sums) -> Array:
        """Return the separation of each pair by trials with these sums, in standard deviations, (..., pairs)."""
        columns = []
        for (_, rival), squares, products in zip(self.pairs, sums.squares, sums.products, strict=True):
            information = self._solvable[rival] + sums.information[rival]
            solved = np.linalg.solve(information, products[..., None])[..., 0]
            columns.append(np.sqrt(np.maximum(squares - (products * solved).sum(axis=-1), 0.0)))
        if not columns:
            return np.zeros((*sums.information[0].shape[:-2], 0))
        return np.stack(columns, axis=-1)

    def smallest(self, separations: Array) -> Array:
        """Return the smallest separation from a rival of each model as the truth, (..., models)."""
        pair_truth = np.array([truth for truth, _ in self.pairs])
        return np.stack(
            [separations[..., pair_truth == truth].min(axis=-1) for truth in range(len(self.models))], axis=-1
        )

    def precision(self, sums: Sums) -> Array:
        """Return the growth of the logarithmic precision of the effects' parameters, (...), as a mean over the models.

        It is half the growth of log(det M / det M_n) with the information M of all parameters and M_n of the nominal
        ones (D_s-optimality: Atkinson, Donev and Tobias, Optimum Experimental Designs, with SAS, 2007, section 10.3).
        """
        growth: Array = np.zeros(sums.information[0].shape[:-2])
        for model, before, added in zip(self.models, self._solvable, sums.information, strict=True):
            both = log_precision(before + added, model.is_effect) - log_precision(before, model.is_effect)
            growth = growth + model.weight * both
        return growth

    def after(self, model: int, sums: Sums) -> tuple[Array, Array]:
        """Return the covariance (P, P) of a model's parameters before and after a trial."""
        before = self._solvable[model]
        return np.linalg.inv(before), np.linalg.inv(before + sums.information[model])

    def remainders(self, truth: int, rival: int, sums: Sums) -> tuple[Array, float]:
        """Return what remains between two models with the rival fitted again to a trial with these sums.

        Returns:
            The differences (N,) in the trial, and the sum of squares by which the rival fits the old data less well.
        """
        a, b, pair = self.models[truth], self.models[rival], self.pairs.index((truth, rival))
        moved = np.linalg.solve(self._solvable[rival] + sums.information[rival], sums.products[pair])
        return a.mean - b.mean - moved @ b.slopes, float(moved @ self._solvable[rival] @ moved)


def log_precision(information: Array, chosen: NDArray[np.bool_]) -> Array:
    """Return half the logarithm of the determinant of the information (..., P, P) about chosen parameters (P,)."""
    rest = ~chosen
    whole = np.linalg.slogdet(information)[1]
    if not rest.any():
        return 0.5 * whole
    return 0.5 * (whole - np.linalg.slogdet(information[..., rest, :][..., :, rest])[1])
