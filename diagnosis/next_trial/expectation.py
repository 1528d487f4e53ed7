"""Expected result of a trial: how far the models are apart, and how probably only the right one remains."""

from dataclasses import dataclass
from math import log, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from diagnosis.inference.fitting.likelihood import LEVELS, MEAN_SHARE, WIDTH
from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.next_trial.models import PredictedUnits
from diagnosis.next_trial.remaining import RemainingModel
from symolo.core.arrays import Array


@dataclass(frozen=True)
class ExpectedPair:
    """A model as the truth, and a rival."""

    truth: str
    rival: str
    separation: float
    """Smallest distance of their predictions, in standard deviations of the noise."""
    cost_rise: float
    """Expected increase of the cost of the rival, with outliers and an unknown level of the noise."""
    excluded: float
    """Probability that the rival is excluded if the other model is true."""


@dataclass(frozen=True)
class ExpectedNumber:
    """Standard error of a number before and after the trial, if its model is true."""

    model: str
    effect: str
    number: str
    value: float
    before: float
    after: float


@dataclass(frozen=True)
class Expectation:
    """What a trial is expected to show. All figures are predictions of the fitted models."""

    pairs: tuple[ExpectedPair, ...]
    numbers: tuple[ExpectedNumber, ...]
    one_right: float
    """Probability that the true model alone remains, if one of the models is true: a lower limit, since the
    probabilities that each of several rivals stays are added."""

    @property
    def smallest(self) -> ExpectedPair | None:
        """The pair with the smallest separation; None for a single model."""
        return min(self.pairs, key=lambda pair: pair.separation, default=None)


def expectation(models: tuple[RemainingModel, ...], trial: PredictedUnits) -> Expectation:
    """Return what is expected of the samples of a trial."""
    statistics = trial.as_one_unit
    sums = statistics.of_units.total()
    separations = statistics.separations(sums)
    pairs = []
    one_right = 0.0
    for truth, model in enumerate(models):
        stays = 0.0
        for (a, rival), separation in zip(statistics.pairs, separations.tolist(), strict=True):
            if a != truth:
                continue
            remainders, old_remainders = statistics.remainders(truth, rival, sums)
            rise = old_remainders + robust_rise(remainders, trial.evidence.quantity[trial.rows])
            ahead = models[rival].rise - model.rise
            excluded = _exceeds(ahead + rise, 2.0 * sqrt(rise))
            pairs.append(ExpectedPair(model.name, models[rival].name, separation, rise, excluded))
            stays += 1.0 - excluded
        one_right += model.weight * max(0.0, 1.0 - stays)
    numbers = []
    for k, model in enumerate(models):
        before, after = statistics.after(k, sums)
        hypothesis, x = model.fit.hypothesis, model.fit.x
        for effect in hypothesis.effects:
            values = hypothesis.values(effect, x)
            earlier, later = (hypothesis.std(effect, x, covariance) for covariance in (before, after))
            numbers += [
                ExpectedNumber(model.name, effect.name, name, values[name], earlier[name], later[name])
                for name in values
            ]
    return Expectation(tuple(pairs), tuple(numbers), one_right)


def robust_rise(remainders: Array, quantity: NDArray[np.int64]) -> float:
    """Return the increase of the cost by remainders (N,) in standard deviations, as the likelihood counts it.

    A few large ones may be outliers, and the noise of a quantity may be up to twice as large as stated, so that the
    cost rises by less than the sum of the squares (`diagnosis.inference.likelihood`).
    """
    outlier = MEAN_SHARE * sqrt(2.0 / np.pi) / WIDTH / (1.0 + (remainders / WIDTH) ** 2)
    squares = -2.0 * np.log(((1.0 - MEAN_SHARE) * np.exp(-0.5 * remainders**2) + outlier) / (1.0 - MEAN_SHARE))
    squares = np.minimum(remainders**2, np.maximum(squares, 0.0))
    rise = 0.0
    for k in np.unique(quantity).tolist():
        mean = 1.0 + float(squares[quantity == k].mean())
        level = min(mean, LEVELS[1] ** 2)
        rise += int(np.count_nonzero(quantity == k)) * (log(level) + mean / level - 1.0)
    return rise


def _exceeds(mean: float, sd: float) -> float:
    """Return the probability that the cost of a rival ends up so far above that it is excluded."""
    return float(ndtr((mean - AS_GOOD) / sd)) if sd > 0.0 else float(mean > AS_GOOD)
