"""Rows of all trials as one array, and channels of a log as what a stage observed."""

from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Channel, Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import noise_of
from diagnosis.predictors.base import Covariate, Observed
from symolo.core.arrays import Array

Scalar = TypeVar("Scalar", bound=np.generic)


def joined(parts: Iterable[NDArray[Scalar]]) -> NDArray[Scalar]:
    """Arrays of all trials one after the other."""
    return np.concatenate(list(parts))


def observed_channel(
    measurement: Measurement, name: str, predictable: Mask, covariates: tuple[Covariate, ...]
) -> Observed:
    """A channel of the log that is predicted sample by sample.

    Args:
        measurement: All of its trials are taken.
        name: Of the channel.
        predictable: (n,), where a stage has a prediction to hold against it.
        covariates: (n,) each.
    """
    if name not in measurement.channel_names():
        return _unobserved(measurement, name, covariates)
    channels, trials = measurement.across(name), measurement.trials
    usable = joined(channel.good for channel in channels) & predictable
    values = joined(channel.values for channel in channels)
    return Observed(
        name=name,
        channel=name,
        unit=channels[0].unit,
        values=np.where(usable, values, np.nan),
        sd=joined(_sd(channel) for channel in channels),
        correlation=channels[0].noise_correlation,
        trial=trial_of_rows(measurement),
        t_s=joined(trial.t_s for trial in trials),
        holdout=joined(trial.holdout for trial in trials),
        usable=usable,
        covariates=covariates,
        noise_is_stated=all(channel.noise_sd is not None for channel in channels),
    )


def _unobserved(measurement: Measurement, name: str, covariates: tuple[Covariate, ...]) -> Observed:
    """A channel that an unseen run has not, so that it can be predicted all the same."""
    trial = trial_of_rows(measurement)
    nothing = np.full(len(trial), np.nan)
    return Observed(
        name=name,
        channel=name,
        unit="",
        values=nothing,
        sd=np.ones(len(trial)),
        correlation=0.0,
        trial=trial,
        t_s=joined(of.t_s for of in measurement.trials),
        holdout=joined(of.holdout for of in measurement.trials),
        usable=np.zeros(len(trial), dtype=bool),
        covariates=covariates,
    )


def given(measurement: Measurement, name: str) -> Array:
    """Good samples of a channel at the rows of all trials, (n,); NaN elsewhere, and where there is no such channel."""
    parts = []
    for trial in measurement.trials:
        channels = [channel for channel in trial.channels if channel.name == name]
        values = [np.where(channel.good, channel.values, np.nan) for channel in channels]
        parts.append(values[0] if values else np.full(len(trial.t_s), np.nan))
    return joined(parts)


def trial_of_rows(measurement: Measurement) -> NDArray[np.int64]:
    """Index of each row's trial, (n,)."""
    return np.repeat(np.arange(len(measurement.trials)), [len(trial.t_s) for trial in measurement.trials])


def session_time_s(measurement: Measurement) -> Array:
    """Of each row, (n,), as far as it was noted; else that of its trial."""
    return joined(trial.t_s + (trial.begins_s or 0.0) for trial in measurement.trials)


def rows_after(measurement: Measurement, step: int, stride: int = 1) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows, every `stride`th of each trial, that have one `step` later in it, and those, (m,) each."""
    firsts, begin = [], 0
    for trial in measurement.trials:
        rows = len(trial.t_s)
        firsts.append(np.arange(begin, begin + max(0, rows - step), stride))
        begin += rows
    first = joined(firsts)
    return first, first + step


def bridged(values: Array, t_s: Array, trials: Sequence[int]) -> Array:
    """Values (n, k) with straight lines over what is missing within a trial; 0 in a trial that has none."""
    found, begin = np.zeros_like(values), 0
    for rows in trials:
        of = slice(begin, begin + rows)
        for column in range(values.shape[1]):
            known = np.isfinite(values[of, column])
            if known.any():
                found[of, column] = np.interp(t_s[of], t_s[of][known], values[of, column][known])
        begin += rows
    return found


def _sd(channel: Channel) -> Array:
    """As the source states it, else as the channel's own scatter shows it; (N,)."""
    if channel.noise_sd is not None:
        return channel.noise_sd
    found = noise_of(channel)
    usable = channel.values[channel.good]
    sd = found.sd if found is not None and found.sd > 0.0 else float(np.std(usable)) if len(usable) else 1.0
    return np.full(len(channel.values), sd or 1.0)
