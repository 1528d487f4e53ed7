"""Rows of all trials as one array, and channels of a log as what a stage observed."""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Array, Channel, Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import noise_of
from diagnosis.stages.base import Covariate, Observed

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
        trial=joined(np.full(len(trial.t_s), k) for k, trial in enumerate(trials)).astype(np.int64),
        t_s=joined(trial.t_s for trial in trials),
        holdout=joined(trial.holdout for trial in trials),
        usable=usable,
        covariates=covariates,
        noise_is_stated=all(channel.noise_sd is not None for channel in channels),
    )


def _sd(channel: Channel) -> Array:
    """As the source states it, else as the channel's own scatter shows it; (N,)."""
    if channel.noise_sd is not None:
        return channel.noise_sd
    found = noise_of(channel)
    usable = channel.values[channel.good]
    sd = found.sd if found is not None and found.sd > 0.0 else float(np.std(usable)) if len(usable) else 1.0
    return np.full(len(channel.values), sd or 1.0)
