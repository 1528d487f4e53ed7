"""One measured quantity of a trial, sample by sample, with what is known of each sample.

Nothing is deleted or repaired: a sample that cannot be trusted keeps its place, and its quality names the reason.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.text_enum import TextEnum
from symolo.core.time_series import TimeSeries

Mask = NDArray[np.bool_]


class Role(TextEnum):
    INPUT = "input"
    """Set or known from outside, such as a voltage or a distance; drives a prediction."""
    READING = "reading"
    """What an instrument said; compared with a prediction."""


class SampleQuality(IntEnum):
    """Why a sample counts or does not."""

    GOOD = 0
    MISSING = 1
    """Not in the log; the value is NaN."""
    NO_TARGET = 2
    """The device's code for a range at which it saw nothing; the value is that code."""
    STALE = 3
    """The value of an earlier time, said again."""


@dataclass(frozen=True)
class Channel:
    """What the log says of one quantity, and how far to trust it."""

    series: TimeSeries
    """Values (N,), NaN exactly where the quality is MISSING."""
    role: Role
    quality: NDArray[np.int8]
    """(N,), of `SampleQuality`."""
    noise_sd: Array | None = None
    """(N,), standard deviation of good readings in the channel's unit, as the source states it; None if it does not."""
    noise_correlation: float = 0.0
    """Of the noise of one sample with that of the next, as its source states it."""
    clock: str = "log"
    """Which clock stamped it. Between two clocks of a trial there may be a constant offset that nobody measured."""

    @classmethod
    def logged(
        cls,
        series: TimeSeries,
        role: Role,
        *,
        no_target: Mask | None = None,
        stale: Mask | None = None,
        noise_sd: Array | None = None,
        noise_correlation: float = 0.0,
        clock: str = "log",
    ) -> "Channel":
        """A channel whose NaN are missing and whose other samples are good, but for those marked, (N,) each."""
        quality = np.full(len(series.t_s), SampleQuality.GOOD, dtype=np.int8)
        for mask, means in ((stale, SampleQuality.STALE), (no_target, SampleQuality.NO_TARGET)):
            if mask is not None:
                quality[mask] = means
        quality[np.isnan(series.values)] = SampleQuality.MISSING
        return cls(series, role, quality, noise_sd, noise_correlation, clock)

    def __post_init__(self) -> None:
        shape = self.series.values.shape
        for what, array in (("quality", self.quality), ("noise_sd", self.noise_sd)):
            if array is not None and array.shape != shape:
                raise ValueError(f"channel {self.name}: {what} of shape {array.shape} for values of {shape}")
        if not np.array_equal(np.isnan(self.series.values), self.quality == SampleQuality.MISSING):
            raise ValueError(f"channel {self.name}: a sample is NaN where it is not missing, or the other way round")
        self.quality.flags.writeable = False
        if self.noise_sd is not None:
            self.noise_sd.flags.writeable = False

    @property
    def name(self) -> str:
        return self.series.name

    @property
    def unit(self) -> str:
        return self.series.unit

    @property
    def values(self) -> Array:
        """(N,), NaN where missing."""
        return self.series.values.astype(np.float64, copy=False)

    @property
    def good(self) -> Mask:
        """(N,)."""
        return self.quality == SampleQuality.GOOD

    @property
    def is_offered(self) -> bool:
        """Whether there is any sample at all."""
        return bool(np.any(self.quality != SampleQuality.MISSING))

    def count(self, quality: SampleQuality) -> int:
        return int(np.count_nonzero(self.quality == quality))


@dataclass(frozen=True)
class Label:
    """What a row is about where that is a word, such as the material of a target."""

    name: str
    values: tuple[str, ...]
    """(N,)."""
