"""All that was observed, of all stages, as one vector of samples; and its predictions by many robots at once."""

from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Observed, Stage
from symolo.core.arrays import Array

MIN_NOISE = 1e-3
"""Share of the nominal noise that every sample keeps: on a sensor's plateau nothing scatters, yet no reading is so sure
that its likelihood could be infinite."""


@dataclass(frozen=True)
class FoundNoise:
    """Of one observed quantity, where its source does not state all of it."""

    factor: float
    """On the standard deviation that the stage states or guesses."""
    correlation: float


@dataclass(frozen=True)
class Prediction:
    mean: Array
    """(M, N)."""
    sd: Array
    """(M, N)."""

    def some(self, which: slice | Sequence[int]) -> "Prediction":
        """Of some of the robots."""
        return Prediction(self.mean[which], self.sd[which])


class Evidence:
    """N samples; those of each observed quantity lie together, in the order of the stages."""

    def __init__(self, stages: Sequence[Stage], noises: Mapping[str, FoundNoise] = MappingProxyType({})) -> None:
        self.stages = tuple(stages)
        self.noises = noises
        """Of the quantities whose source does not state all of it."""
        self._factors = {name: found.factor for name, found in noises.items()}
        self.observed: tuple[Observed, ...] = tuple(of for stage in stages for of in stage.observed)
        self.values = np.concatenate([of.values for of in self.observed])
        self.sd = np.concatenate([of.sd * self._factors.get(of.name, 1.0) for of in self.observed])
        """(N,), by the nominal robot."""
        holdout = np.concatenate([of.holdout for of in self.observed])
        usable = np.concatenate([of.usable for of in self.observed])
        self.fit: Mask = usable & ~holdout
        """(N,), samples that may choose and fit."""
        self.heldout: Mask = usable & holdout
        self.correlations = [
            noises[of.name].correlation if of.name in noises else of.correlation or 0.0 for of in self.observed
        ]
        """Of the noise of a sample with the next, of each observed quantity."""
        worth = [
            np.full(len(of.values), _independent(p)) for of, p in zip(self.observed, self.correlations, strict=True)
        ]
        self.weight = np.concatenate(worth)
        """(N,), independent samples that one is worth, for noise that lasts longer than a row says less."""
        self.known: dict[Hashable, object] = {}
        """What was worked out of it (`diagnosis.inference.evidence.remembered`)."""

    @cached_property
    def resolution(self) -> Array:
        """(N,), step to which a sample is rounded; 0 where none is known."""
        return np.concatenate([np.full(len(of.values), of.resolution) for of in self.observed])

    @cached_property
    def quantity(self) -> NDArray[np.int64]:
        """(N,), which observed quantity a sample is of."""
        return np.repeat(np.arange(len(self.observed)), [len(of.values) for of in self.observed])

    @cached_property
    def places(self) -> tuple[slice, ...]:
        """Where each observed quantity stands in the vector."""
        ends = np.cumsum([len(of.values) for of in self.observed]).tolist()
        return tuple(slice(end - len(of.values), end) for of, end in zip(self.observed, ends, strict=True))

    @cached_property
    def of_stage(self) -> NDArray[np.int64]:
        """(N,), which stage a sample is of."""
        counts = [sum(len(of.values) for of in stage.observed) for stage in self.stages]
        return np.repeat(np.arange(len(self.stages)), counts)

    @cached_property
    def trial(self) -> NDArray[np.int64]:
        """(N,)."""
        return np.concatenate([of.trial for of in self.observed])

    def without(self, channel: str) -> "Evidence":
        """The same, with no rows of a channel to be fitted."""
        others = copy(self)
        others.known = {}
        others.fit = self.fit.copy()
        for quantity, place in zip(self.observed, self.places, strict=True):
            if quantity.channel == channel:
                others.fit[place] = False
        return others

    def of(self, robots: Sequence[RobotConfig]) -> Prediction:
        """By each robot; a sample that is not usable is predicted as NaN or anything."""
        mean, sd = (np.empty((len(robots), len(self.values))) for _ in range(2))
        first = 0
        for stage in self.stages:
            places = self.places[first : first + len(stage.observed)]
            first += len(stage.observed)
            for begin in range(0, len(robots), stage.at_once):
                some = slice(begin, begin + stage.at_once)
                for of, place, predicted in zip(stage.observed, places, stage.predict(robots[some]), strict=True):
                    mean[some, place] = predicted.mean
                    sd[some, place] = self._factors.get(of.name, 1.0) * predicted.sd
        return Prediction(mean, np.maximum(sd, MIN_NOISE * self.sd))


def _independent(correlation: float) -> float:
    """Of AR(1) noise: the variance of a mean of many samples is (1 + p)/(1 - p) times that of independent ones."""
    return (1.0 - correlation) / (1.0 + correlation)
