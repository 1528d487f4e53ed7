"""All observations of all stages as one vector of samples, and their predictions by many robots at once."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import overload

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.drift_memory import DriftMemory
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Observed, Stage
from diagnosis.predictors.wheels.count_noise import Whitening
from symolo.core.arrays import Array

MIN_NOISE = 1e-3
"""Smallest noise of a sample, as a share of the nominal noise. On the plateau of a sensor nothing scatters, but no
reading is so certain that its likelihood may become infinite."""


@dataclass(frozen=True)
class EstimatedNoise:
    """Noise of one observed quantity that was estimated from the data, since the source does not state all of it."""

    factor: float
    """Factor on the standard deviation of the stage."""
    correlation: float
    early_share: float = 0.0
    """Standard deviation of the share of a change of the voltage that acts before it is logged (`EarlyVoltages`)."""
    torque: float | None = None
    """Standard deviation of a speed by a random torque (`CountNoise`); None if it is as stated."""


@dataclass(frozen=True)
class Prediction:
    """Predictions of N samples by M robots."""

    mean: Array
    """(M, N), means of the samples."""
    sd: Array
    """(M, N), standard deviations of their noise."""
    by_tolerances: Array
    """(M,), part of the squares of the residuals that comes from numbers which leave their tolerances (`Predicted`)."""

    def some(self, which: slice | Sequence[int]) -> "Prediction":
        """Return the predictions by some of the robots."""
        return Prediction(self.mean[which], self.sd[which], self.by_tolerances[which])

    def moved(self, change: Array | float) -> "Prediction":
        """Return the predictions with a change (..., N) of all means, such as the errors of a session."""
        return self if np.ndim(change) == 0 and change == 0.0 else replace(self, mean=self.mean + change)


class Evidence:
    """N samples. The samples of each observed quantity are adjacent, in the order of the stages."""

    def __init__(self, stages: Sequence[Stage], noises: Mapping[str, EstimatedNoise] = MappingProxyType({})) -> None:
        self.stages = tuple(stages)
        self.noises = noises
        """Estimated noise by quantity."""
        self.observed: tuple[Observed, ...] = tuple(observed for stage in stages for observed in stage.observed)
        self.counts = [len(observed.values) for observed in self.observed]
        """Number of samples of each observed quantity."""
        self.readings = np.concatenate([observed.values for observed in self.observed])
        """(N,), readings as they were measured."""
        self.whitenings = [self._whitening_of(observed) for observed in self.observed]
        """Filter of each observed quantity that makes its noise independent; None where it is so already."""
        self.values = self.whitened(self.readings)
        """(N,), readings with independent noise, to which predictions are compared."""
        self.sd = np.concatenate([self._sd_of(observed, observed.sd) for observed in self.observed])
        """(N,), standard deviation of the noise by the nominal robot."""
        holdout = np.concatenate([observed.holdout for observed in self.observed])
        usable = np.concatenate([observed.usable for observed in self.observed])
        self.fit: Mask = usable & ~holdout
        """(N,), samples to which all numbers are fitted."""
        self.heldout: Mask = usable & holdout
        """(N,), samples for the gain, which also help to decide which effects are named; nothing is fitted to them."""
        self.correlations = [
            noises[observed.name].correlation if observed.name in noises else observed.correlation or 0.0
            for observed in self.observed
        ]
        """Correlation of the noise of successive samples, by observed quantity."""
        # The variance of a mean of many AR(1) samples is (1 + p)/(1 - p) times that of independent ones.
        self.weight = np.repeat([(1.0 - p) / (1.0 + p) for p in self.correlations], self.counts)
        """(N,), number of independent samples that a sample is worth."""
        self.memory: DriftMemory | None = None
        """What a random drift carries over from row to row; None without any."""
        self.memo: dict[Hashable, object] = {}
        """Results of the functions that are `memoized`, by function and arguments."""
        self.on_predicted: Callable[[int], None] = _nothing
        """Called with the number of robots before each prediction, which is nearly all the work of a fit."""
        self.on_fits: Callable[[Sequence[str], int], None] = _no_fits
        """Called with the names of the hypotheses that are still fitted side by side, and how many they were."""

    @cached_property
    def resolution(self) -> Array:
        """(N,), step to which a sample is rounded; 0 where it is not known."""
        return np.repeat([float(observed.resolution) for observed in self.observed], self.counts)

    @cached_property
    def quantity(self) -> NDArray[np.int64]:
        """(N,), index of the observed quantity of a sample."""
        return np.repeat(np.arange(len(self.observed)), self.counts)

    @cached_property
    def places(self) -> tuple[slice, ...]:
        """Positions of each observed quantity in the vector."""
        ends = np.cumsum(self.counts).tolist()
        return tuple(slice(end - count, end) for count, end in zip(self.counts, ends, strict=True))

    @cached_property
    def stage_index(self) -> NDArray[np.int64]:
        """(N,), index of the stage of a sample."""
        counts = [sum(len(observed.values) for observed in stage.observed) for stage in self.stages]
        return np.repeat(np.arange(len(self.stages)), counts)

    @cached_property
    def trial(self) -> NDArray[np.int64]:
        """(N,), index of the trial of a sample."""
        return np.concatenate([observed.trial for observed in self.observed])

    def with_rows(self, *, fit: Mask | None = None, heldout: Mask | None = None) -> "Evidence":
        """Return the same evidence with other samples (N,) for the fit or for the gain."""
        others = self._without_results()
        others.fit = self.fit if fit is None else fit
        others.heldout = self.heldout if heldout is None else heldout
        return others

    def with_noises(self, noises: Mapping[str, EstimatedNoise]) -> "Evidence":
        """Return the same evidence with other estimated noises."""
        others = Evidence(self.stages, noises)
        others.readings, others.memory = self.readings, self.memory
        others.values = others.compared(self.readings)
        if self.memory is not None:
            others.sd *= self.memory.wider
        others.on_predicted, others.on_fits = self.on_predicted, self.on_fits
        return others

    def without(self, error: Array) -> "Evidence":
        """Return the same evidence with an error (N,), in the units of the samples, taken out of what was measured."""
        others = self._without_results()
        others.readings = self.readings - error
        others.values = others.compared(others.readings)
        return others

    @overload
    def whitened(self, samples: Array) -> Array: ...
    @overload
    def whitened(self, samples: Array | float) -> Array | float: ...
    def whitened(self, samples: Array | float) -> Array | float:
        """Return readings (..., N), or changes of them, as samples with independent noise; 0 for no change."""
        if all(whitening is None for whitening in self.whitenings) or np.ndim(samples) == 0:
            return samples
        result = np.array(samples)
        for place, whitening in zip(self.places, self.whitenings, strict=True):
            if whitening is not None:
                result[..., place] = whitening.applied(result[..., place])
        return result

    def as_measured(self) -> "Evidence":
        """Return the same evidence with the readings themselves, whose noise may be dependent."""
        others = self._without_results()
        others.whitenings = [None] * len(self.observed)
        others.values = others.compared(self.readings)
        return others

    def whitened_part(self, number: int, changes: Array) -> Array:
        """Return changes (n, k) of the readings of one quantity as those of its samples."""
        whitening = self.whitenings[number]
        return changes if whitening is None else whitening.applied(changes.T).T

    def unwhitened(self, number: int, residuals: Array) -> Array:
        """Return residuals (n,) of the samples of one quantity in sigmas as those of its readings."""
        whitening = self.whitenings[number]
        return residuals if whitening is None else whitening.undone(residuals)

    def beside(self, memory: DriftMemory) -> "Evidence":
        """Return the same evidence beside a random drift: each sample is compared with what others say about it."""
        others = self._without_results()
        others.memory = memory
        others.values, others.sd = others.compared(self.readings), self.sd * memory.wider
        return others

    def compared(self, readings: Array) -> Array:
        """Return readings (N,) as they are compared with predictions."""
        values = self.whitened(readings)
        return values if self.memory is None else values - self.memory.carried(values)

    def predicted(self, robots: Sequence[RobotConfig]) -> Prediction:
        """Return the predictions by each robot; a sample that is not usable may be NaN or have any value."""
        self.on_predicted(len(robots))
        mean, sd = (np.empty((len(robots), len(self.values))) for _ in range(2))
        by_tolerances = np.zeros(len(robots))
        first = 0
        for stage in self.stages:
            places = self.places[first : first + len(stage.observed)]
            start, first = first, first + len(stage.observed)
            for begin in range(0, len(robots), stage.at_once):
                batch = slice(begin, begin + stage.at_once)
                for number, (observed, place, predicted) in enumerate(
                    zip(stage.observed, places, stage.predict(robots[batch]), strict=True), start
                ):
                    whitening = self.whitenings[number]
                    mean[batch, place] = predicted.mean if whitening is None else whitening.applied(predicted.mean)
                    sd[batch, place] = self._sd_of(observed, predicted.sd)
                    if predicted.by_tolerances is not None:
                        by_tolerances[batch] += predicted.by_tolerances
        if self.memory is not None:
            mean, sd = mean - self.memory.carried(mean), sd * self.memory.wider
        return Prediction(mean, np.maximum(sd, MIN_NOISE * self.sd), by_tolerances)

    def has_early_voltages(self, observed: Observed) -> bool:
        """Return whether the noise of a quantity includes that of voltages which act before they are logged."""
        noise = self.noises.get(observed.name)
        return observed.early is not None and noise is not None and noise.early_share > 0.0

    def _without_results(self) -> "Evidence":
        """Return a copy, to be changed, without the memoized results, which hold only for this evidence."""
        others = copy(self)
        others.memo = {}
        return others

    def _whitening_of(self, observed: Observed) -> Whitening | None:
        if observed.count_noise is None:
            return None
        noise = self.noises.get(observed.name)
        torque = None if noise is None else noise.torque
        return observed.count_noise.whitening(observed.count_noise.torque if torque is None else torque)

    def _sd_of(self, observed: Observed, sd: Array) -> Array:
        """Return the standard deviations (..., n) of a quantity with its estimated noise, from those of its stage."""
        noise = self.noises.get(observed.name)
        if noise is None:
            return sd
        sd = noise.factor * sd
        return sd if observed.early is None else np.hypot(sd, noise.early_share * observed.early.scatter)


def _nothing(_robots: int) -> None:
    """Do nothing."""


def _no_fits(_names: Sequence[str], _of: int) -> None:
    """Do nothing."""
