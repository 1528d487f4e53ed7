"""Properties of a log that need no model: rate, gaps, noise and outliers. Nothing is changed."""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Channel, Mask
from diagnosis.measured.noise import Noise, noise_of_differences, trimmed_variance
from logs.times import usual_step
from symolo.core.arrays import Array

GAP = 1.5
"""Steps of time above this multiple of the usual step are gaps."""
STANDS_OUT = 6.0
"""Deviation of an outlier in standard deviations; of a million normal deviates none is expected beyond it."""
SAME = 0.7
"""Share of its size by which a spike must differ from the lines through its neighbours on both sides."""


@dataclass(frozen=True)
class Timing:
    """Rate and gaps of time stamps."""

    period_s: float
    """Usual time between two rows [s]."""
    longest_s: float
    gaps: int
    """Number of steps of more than 1.5 periods."""

    @property
    def rate_hz(self) -> float:
        return 1.0 / self.period_s


def timing(t_s: Array) -> Timing | None:
    """Return the timing of one trial; None with a single row."""
    steps = np.diff(t_s)
    if not len(steps):
        return None
    period_s = usual_step(steps)
    return Timing(period_s, float(steps.max()), int(np.count_nonzero(steps > GAP * period_s)))


def joined(t_s: Array) -> Mask:
    """Return whether there is no gap between a row and the next, (N - 1,)."""
    steps = timing(t_s)
    return np.diff(t_s) <= GAP * steps.period_s if steps else np.zeros(0, dtype=bool)


def usable(channel: Channel) -> Array:
    """Return the values (N,), NaN where the quality is not good."""
    return np.where(channel.good, channel.values, np.nan)


def noise_of(channel: Channel) -> Noise | None:
    """Return the noise of a channel that is sampled often, at least that of rounding to its resolution."""
    values = usable(channel)
    noise, step = noise_of_differences(values, joined(channel.series.t_s)), resolution(values)
    # An error of rounding is uniform over one step, and then its variance is step^2 / 12.
    if noise is None or step is None or noise.sd**2 >= step**2 / 12.0:
        return noise
    return Noise(float(step / np.sqrt(12.0)), 0.0, noise.rows, is_resolved=False)


def spikes(channel: Channel) -> Mask:
    """Return which samples (N,) are single outliers from the mean of their two neighbours.

    The difference from that mean must be larger than six of its standard deviations, and than three times what 19 of
    20 samples have, since the noise says little about a channel that moves in jerks. To distinguish a spike from a step
    and from the peak of a decay, the sample must be at least 70 % as far from the lines through the two samples before
    it and the two after it, on the same side. A channel without noise has no spikes. Next to a step, the neighbour of a
    spike may be marked as well.
    """
    values, whole = usable(channel), joined(channel.series.t_s)
    is_spike = np.zeros(len(values), dtype=bool)
    noise = noise_of_differences(values, whole)
    if noise is None or noise.sd == 0.0 or len(values) < 5:
        return is_spike
    here = values[2:-2]
    off = here - 0.5 * (values[1:-3] + values[3:-1])
    before, after = here - (2.0 * values[1:-3] - values[:-4]), here - (2.0 * values[3:-1] - values[4:])
    together = whole[:-3] & whole[1:-2] & whole[2:-1] & whole[3:]
    size = np.where(together & np.isfinite(off + before + after), np.abs(off), 0.0)
    # The mean of two neighbours adds half of the variance of the noise to that of the sample.
    bound = max(STANDS_OUT * np.sqrt(1.5) * noise.sd, 3.0 * float(np.quantile(size, 0.95)))
    alone = np.minimum(before * np.sign(off), after * np.sign(off)) > SAME * size
    is_spike[2:-2] = alone & (size > bound)
    return is_spike


def far_out(deviations: Array) -> Mask:
    """Return which of the deviations (N,), in any order, are far from their median; NaN are not."""
    centred = deviations - np.nanmedian(deviations) if np.isfinite(deviations).any() else deviations
    with np.errstate(invalid="ignore"):
        return np.abs(centred) > STANDS_OUT * np.sqrt(trimmed_variance(centred))


def resolution(values: Array) -> float | None:
    """Return the step of which all values are multiples to within a fiftieth; None if there is none."""
    distinct = np.unique(values[np.isfinite(values)])
    steps = np.diff(distinct)
    steps = steps[steps > 1e-6 * float(np.abs(distinct).max(initial=0.0))]
    if not len(steps):
        return None
    step = float(steps.min())
    off = steps / step
    return step if float(np.abs(off - np.rint(off)).max()) < 0.02 else None
