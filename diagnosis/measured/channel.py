"""One measured quantity of a trial, with the quality of each sample.

Nothing is deleted or repaired: a sample that cannot be trusted keeps its place, and its quality names the reason.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.tables.time_series import TimeSeries
from symolo.core.text_enum import TextEnum

Mask = NDArray[np.bool_]


class Role(TextEnum):
    """Part that a channel has in a comparison."""

    INPUT = "input"
    """Quantity that was set or is known, such as a voltage or a distance; a prediction is computed from it."""
    READING = "reading"
    """Value of an instrument; it is compared with a prediction."""


class SampleQuality(IntEnum):
    """Why a sample counts or does not."""

    GOOD = 0
    MISSING = 1
    """Sample that is not in the log; its value is NaN."""
    NO_TARGET = 2
    """Range sensor without a target; the value is the device's code for that."""
    STALE = 3
    """Repeated value of an earlier time."""


_MISSING = int(SampleQuality.MISSING)
"""A look-up of a member of an enumeration takes as long as a comparison of a short column."""


@dataclass(frozen=True)
class Channel:
    """Logged samples of one quantity, with their quality and noise."""

    series: TimeSeries
    """Values (N,), NaN exactly where the quality is MISSING."""
    role: Role
    quality: NDArray[np.int8]
    """(N,), `SampleQuality` of each sample."""
    noise_sd: Array | None = None
    """(N,), stated standard deviation of good readings in the channel's unit; None if the source does not state it."""
    noise_correlation: float = 0.0
    """Stated correlation of the noise of one sample with that of the next."""
    clock: str = "log"
    """Name of the clock of the times. Two clocks of a trial may differ by a constant offset that is not known."""

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
        """Return a channel whose NaN are missing and whose other samples are good unless a mask (N,) marks them."""
        quality = np.zeros(len(series.t_s), dtype=np.int8)  # all are good
        for mask, means in ((stale, SampleQuality.STALE), (no_target, SampleQuality.NO_TARGET)):
            if mask is not None:
                quality[mask] = means
        quality[np.isnan(series.values)] = _MISSING
        return cls(series, role, quality, noise_sd, noise_correlation, clock)

    def __post_init__(self) -> None:
        shape = self.series.values.shape
        for what, array in (("quality", self.quality), ("noise_sd", self.noise_sd)):
            if array is not None and array.shape != shape:
                raise ValueError(f"channel {self.name}: {what} of shape {array.shape} for values of {shape}")
        if (np.isnan(self.series.values) != (self.quality == _MISSING)).any():
            raise ValueError(f"channel {self.name}: NaN and the quality MISSING do not agree")
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
        """Return the values (N,), NaN where missing."""
        return self.series.values.astype(np.float64, copy=False)

    @property
    def good(self) -> Mask:
        """Return which samples are good, (N,)."""
        return self.quality == SampleQuality.GOOD

    @property
    def is_offered(self) -> bool:
        """Return whether the channel has any sample."""
        return bool((self.quality != _MISSING).any())

    def count(self, quality: SampleQuality) -> int:
        return int(np.count_nonzero(self.quality == quality))


@dataclass(frozen=True)
class Label:
    """Words that describe the rows, such as the material of a target."""

    name: str
    values: tuple[str, ...]
    """(N,), word of each row."""
