"""What a log is like before any model looks at it: rate, gaps, and samples that stand out. Nothing is changed."""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Channel, Mask
from diagnosis.measured.noise import Noise, noise_of_differences, trimmed_variance
from symolo.core.arrays import Array

GAP = 1.5
"""Steps of time longer than so many usual ones are gaps."""
STANDS_OUT = 6.0
"""Standard deviations; of a million normal deviates, none is expected there."""
SAME = 0.7
"""Of a spike's size, at which it stands out on either side."""


@dataclass(frozen=True)
class Timing:
    period_s: float
    """The usual step."""
    shortest_s: float
    longest_s: float
    gaps: int
    """Steps of more than 1.5 periods."""

    @property
    def rate_hz(self) -> float:
        return 1.0 / self.period_s


def usual(steps_s: Array) -> float:
    """The median step, of two in the middle the shorter: a gap is never usual."""
    return float(np.sort(steps_s)[(len(steps_s) - 1) // 2])


def timing(t_s: Array) -> Timing | None:
    """Of one trial; None with a single row."""
    steps = np.diff(t_s)
    if not len(steps):
        return None
    period_s = usual(steps)
    return Timing(period_s, float(steps.min()), float(steps.max()), int(np.count_nonzero(steps > GAP * period_s)))


def joined(t_s: Array) -> Mask:
    """(N - 1,), whether there is no gap between a row and the next."""
    found = timing(t_s)
    return np.diff(t_s) <= GAP * found.period_s if found else np.zeros(0, dtype=bool)


def usable(channel: Channel) -> Array:
    """(N,), the values, NaN where the quality is not good."""
    return np.where(channel.good, channel.values, np.nan)


def noise_of(channel: Channel) -> Noise | None:
    """Of a channel that is sampled often, at least that of the rounding to its resolution (uniform: step^2/12)."""
    values = usable(channel)
    found, step = noise_of_differences(values, joined(channel.series.t_s)), resolution(values)
    if found is None or step is None or found.sd**2 >= step**2 / 12.0:
        return found
    return Noise(float(step / np.sqrt(12.0)), 0.0, found.rows, is_resolved=False)


def spikes(channel: Channel) -> Mask:
    """(N,), single samples far off the middle of their neighbours.

    Far is six standard deviations of that difference, whose variance is 3/2 that of the noise; and three times as far
    as 19 in 20 samples are, for where a channel moves in jerks its noise says little. To tell spikes from steps and
    from the peaks of decays, the sample must be as far, but for 30 %, off the lines through the two before and the two
    after, and to the same side. Where a channel has no noise to speak of, nothing is said. Beside a step, a neighbour
    of a spike may be taken for one too.
    """
    values, whole = usable(channel), joined(channel.series.t_s)
    found = np.zeros(len(values), dtype=bool)
    noise = noise_of_differences(values, whole)
    if noise is None or noise.sd == 0.0 or len(values) < 5:
        return found
    here = values[2:-2]
    off = here - 0.5 * (values[1:-3] + values[3:-1])
    before, after = here - (2.0 * values[1:-3] - values[:-4]), here - (2.0 * values[3:-1] - values[4:])
    together = whole[:-3] & whole[1:-2] & whole[2:-1] & whole[3:]
    size = np.where(together & np.isfinite(off + before + after), np.abs(off), 0.0)
    bound = max(STANDS_OUT * np.sqrt(1.5) * noise.sd, 3.0 * float(np.quantile(size, 0.95)))
    alone = np.minimum(before * np.sign(off), after * np.sign(off)) > SAME * size
    found[2:-2] = alone & (size > bound)
    return found


def far_out(deviations: Array) -> Mask:
    """(N,), deviates far from the middle of all of them, in no order; NaN are not."""
    centred = deviations - np.nanmedian(deviations) if np.isfinite(deviations).any() else deviations
    with np.errstate(invalid="ignore"):
        return np.abs(centred) > STANDS_OUT * np.sqrt(trimmed_variance(centred))


def resolution(values: Array) -> float | None:
    """The step that all values lie on, to a fiftieth of it; None where they lie on none, or are all the same."""
    distinct = np.unique(values[np.isfinite(values)])
    steps = np.diff(distinct)
    steps = steps[steps > 1e-6 * float(np.abs(distinct).max(initial=0.0))]
    if not len(steps):
        return None
    step = float(steps.min())
    off = steps / step
    return step if float(np.abs(off - np.rint(off)).max()) < 0.02 else None
