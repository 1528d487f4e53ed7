"""Rows of all trials as one array, and channels of a log as observations of a stage."""

from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Channel, Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import noise_of
from diagnosis.predictors.base import Covariate, CovariateShape, Observed
from symolo.core.arrays import Array

Scalar = TypeVar("Scalar", bound=np.generic)
APART = 2
"""Rows from one row to another in whose pose it has no part, if a prediction is for a time between two rows."""


def joined(parts: Iterable[NDArray[Scalar]]) -> NDArray[Scalar]:
    """Return the arrays of all trials in one."""
    return np.concatenate(list(parts))


def observed_channel(
    measurement: Measurement, name: str, predictable: Mask, covariates: tuple[Covariate, ...]
) -> Observed:
    """Return a channel of the log that is predicted sample by sample; in an unseen run it has no values.

    Args:
        measurement: All trials are used.
        name: Name of the channel.
        predictable: (n,), where the stage has a prediction.
        covariates: Covariates with (n,) values.
    """
    rows = len(predictable)
    channels = measurement.across(name) if name in measurement.channel_names() else ()
    usable = joined(channel.good for channel in channels) & predictable if channels else np.zeros(rows, dtype=bool)
    values = joined(channel.values for channel in channels) if channels else np.full(rows, np.nan)
    return Observed(
        name=name,
        channel=name,
        unit=channels[0].unit if channels else "",
        values=np.where(usable, values, np.nan),
        sd=joined(_sd(channel) for channel in channels) if channels else np.ones(rows),
        correlation=channels[0].noise_correlation if channels else 0.0,
        trial=trial_of_rows(measurement),
        t_s=joined(trial.t_s for trial in measurement.trials),
        holdout=held_out_rows(measurement),
        usable=usable,
        covariates=covariates,
        noise_is_stated=all(channel.noise_sd is not None for channel in channels),
    )


def good_values(measurement: Measurement, name: str) -> Array:
    """Return the good samples of a channel in the rows of all trials, (n,); NaN elsewhere, or without the channel."""
    parts = []
    for trial in measurement.trials:
        channels = [channel for channel in trial.channels if channel.name == name]
        values = [np.where(channel.good, channel.values, np.nan) for channel in channels]
        parts.append(values[0] if values else np.full(len(trial.t_s), np.nan))
    return joined(parts)


def held_out_rows(measurement: Measurement) -> Mask:
    """Return which rows of all trials are held out, (n,)."""
    return joined(trial.holdout for trial in measurement.trials)


def trial_of_rows(measurement: Measurement) -> NDArray[np.int64]:
    """Return the index of the trial of each row, (n,)."""
    return np.repeat(np.arange(len(measurement.trials)), [len(trial.t_s) for trial in measurement.trials])


def trial_covariate(measurement: Measurement, rows: NDArray[np.int64] | None = None) -> Covariate:
    """Return the covariate with the trial of all rows, or of some."""
    trial = trial_of_rows(measurement)
    names = tuple(trial.name for trial in measurement.trials)
    return Covariate(
        "trial", (trial if rows is None else trial[rows]).astype(float), CovariateShape.CATEGORY, labels=names
    )


def session_time_s(measurement: Measurement) -> Array:
    """Return the time of each row since the start of the session, (n,); since the start of its trial if not known."""
    return joined(trial.t_s + (trial.begins_s or 0.0) for trial in measurement.trials)


def rows_after(measurement: Measurement, step: int, stride: int = 1) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return every `stride`th row of each trial that has a row `step` later, and the later rows, (m,) each."""
    firsts, begin = [], 0
    for trial in measurement.trials:
        rows = len(trial.t_s)
        firsts.append(np.arange(begin, begin + max(0, rows - step), stride))
        begin += rows
    first = joined(firsts)
    return first, first + step


def by_other_rows(values: Array, trial: NDArray[np.int64]) -> Array:
    """Return values (n, ...) that change slowly, each by the mean of those two rows before and after it.

    A covariate that is computed from a logged pose has the noise of this pose. So has the prediction, and a residual
    would seem to depend on the covariate: in a drive along a wall, a range that is predicted too long always leaves a
    residual that is too small. The noise of other rows is independent. A prediction for a time between two rows has the
    noise of both, so that the next row but one is taken.

    Args:
        values: Values of the rows of all trials.
        trial: (n,), trial of each row; where it has no such row on one side, that on the other side counts alone, and
            the row itself if there is none on either side.
    """
    row = np.arange(len(values))
    before, after = row - APART, row + APART
    has_before = (before >= 0) & (trial[np.maximum(before, 0)] == trial)
    has_after = (after < len(row)) & (trial[np.minimum(after, len(row) - 1)] == trial)
    before = np.where(has_before, before, np.where(has_after, after, row))
    after = np.where(has_after, after, before)
    return 0.5 * (values[before] + values[after])


def step_by_other_rows(values: Array, trial: NDArray[np.int64]) -> Array:
    """Return the mean change from row to row of values (n, ...), by the rows APART before and after.

    Where one of these is missing or of another trial, it is NaN.
    """
    step, middle = np.full(values.shape, np.nan), np.arange(APART, len(values) - APART)
    inside = middle[trial[middle - APART] == trial[middle + APART]]
    step[inside] = (values[inside + APART] - values[inside - APART]) / (2.0 * APART)
    return step


def bridged(values: Array, t_s: Array, trials: Sequence[int]) -> Array:
    """Return values (n, k) with gaps within a trial interpolated; 0 in a trial without values."""
    filled, begin = np.zeros_like(values), 0
    for rows in trials:
        part = slice(begin, begin + rows)
        for column in range(values.shape[1]):
            known = np.isfinite(values[part, column])
            if known.any():
                filled[part, column] = np.interp(t_s[part], t_s[part][known], values[part, column][known])
        begin += rows
    return filled


def _sd(channel: Channel) -> Array:
    """Return the standard deviation (n,) that the source states, or an estimate from the scatter of the channel."""
    if channel.noise_sd is not None:
        return channel.noise_sd
    noise = noise_of(channel)
    usable = channel.values[channel.good]
    sd = noise.sd if noise is not None and noise.sd > 0.0 else float(np.std(usable)) if len(usable) else 1.0
    return np.full(len(channel.values), sd or 1.0)
