"""Rows of a log on a regular grid of samples, all trials side by side, for models with time steps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.measured.screening import GAP
from logs.times import usual_step
from symolo.core.arrays import Array
from symolo.core.errors import InputError

OFF_GRID = 0.25
"""Root mean square distance in periods, from which the rows of a log are not on the grid of a rate. Evenly spread
distances of up to half a period would give 0.29."""


@dataclass(frozen=True)
class Grid:
    """Samples 0 to T - 1 of N trials, one period apart; at sample 0, which is time 0, everything is at rest."""

    period_s: float
    places: tuple[NDArray[np.int64], ...]
    """Indices of the samples of the rows of each trial."""
    begins_s: Array
    """(N,), time of sample 0 since the start of the session."""

    @classmethod
    def from_measurement(cls, measurement: Measurement, rate_hz: float | None) -> "Grid":
        """Return the grid of the nominal rate if the rows are on it, else the grid that fits the rows best.

        Raises:
            InputError: Two rows of a trial fall on the same sample.
        """
        period_s = _period_s(measurement, rate_hz)
        places = tuple(_places(trial, period_s, measurement) for trial in measurement.trials)
        return cls(period_s, places, np.array([trial.begins_s or 0.0 for trial in measurement.trials]))

    @property
    def samples(self) -> int:
        return max(1, *(int(place[-1]) for place in self.places)) + 1

    def zero_order_hold(self, trials: tuple[Trial, ...], name: str) -> Array:
        """Return a channel at every sample, (T, N); missing values are those of the row before, and 0 at the start."""
        return self.held(np.concatenate([trial[name].values for trial in trials]))

    def held(self, values: Array) -> Array:
        """Return values (n, ...) of the rows of all trials at every sample, (T, N, ...), held as a zero-order hold."""
        samples = self.at_samples(values)
        number = np.arange(self.samples).reshape(-1, *(1,) * (samples.ndim - 1))
        last = np.maximum.accumulate(np.where(np.isfinite(samples), number, -1))
        return np.where(last >= 0, np.take_along_axis(samples, np.maximum(last, 0), axis=0), 0.0)

    def at_samples(self, values: Array) -> Array:
        """Return values (n, ...) of the rows of all trials at the samples, (T, N, ...); NaN where there is no row."""
        samples, begin = np.full((self.samples, len(self.places), *values.shape[1:]), np.nan), 0
        for k, place in enumerate(self.places):
            samples[place, k] = values[begin : begin + len(place)]
            begin += len(place)
        return samples

    def of_rows(self, samples: Array) -> Array:
        """Return samples (T, ..., N) at the rows of all trials, (..., n)."""
        return np.concatenate([samples[place, ..., k].T for k, place in enumerate(self.places)], axis=-1)


def _period_s(measurement: Measurement, rate_hz: float | None) -> float:
    """Return the period of the nominal rate if the rows are on its grid, else the one that fits them best."""
    t_s = np.concatenate([trial.t_s for trial in measurement.trials])
    if rate_hz is not None:
        places = t_s * rate_hz
        if np.sqrt(np.mean((places - np.rint(places)) ** 2)) < OFF_GRID:
            return 1.0 / rate_hz
    return _fitted_period_s(measurement.trials)


def _fitted_period_s(trials: tuple[Trial, ...]) -> float:
    """Return the least-squares slope of times over sample numbers, with a separate start for each trial.

    The median step would not do: the times of a log are rounded, and it would drift away from the rows. If no trial has
    two rows, the time of the first row is returned.
    """
    steps = np.concatenate([np.diff(trial.t_s) for trial in trials])
    if not len(steps):
        return float(trials[0].t_s[0]) or 1.0
    period_s = float(steps[steps <= GAP * usual_step(steps)].mean())
    products = squares = 0.0
    for trial in trials:
        number = np.concatenate([[0.0], np.cumsum(np.maximum(np.rint(np.diff(trial.t_s) / period_s), 1.0))])
        number -= number.mean()
        products += float(number @ trial.t_s)
        squares += float(number @ number)
    return products / squares


def _places(trial: Trial, period_s: float, measurement: Measurement) -> NDArray[np.int64]:
    """Return the sample of each row, (n,); sample 0 is the state at rest."""
    place = np.maximum(np.rint(trial.t_s / period_s).astype(np.int64), 0)
    same = np.flatnonzero(np.diff(place) == 0).tolist()
    if same:
        first, second = trial.t_s[same[0] : same[0] + 2].tolist()
        raise InputError(
            f"column t_s: {first:.10g} and {second:.10g} of trial {trial.name} fall on the same sample",
            where=measurement.where,
            allowed=f"samples {period_s:.6g} s apart",
            cure="keep one of the two rows, and check the rate",
        )
    return place
