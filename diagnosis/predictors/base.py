"""What a stage is: one link of the signal chain, simulated from what was *measured* at its input.

A wrong motor then does not spoil the poses, errors do not add up along a drive, and where measurement and prediction
part tells where the fault is. The stages run the simulator's own models, so that what a diagnosis finds is a fault of
the robot and not of a second model.

A stage is bound to one measurement: it keeps what was observed, flat over all trials, and predicts the same samples by
any number of robots at once, for a fit asks for thousands of predictions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from symolo.core.arrays import Array

ROW_TIME = "t_s"
"""Name of the covariate that is the time of a row: rows of a trial follow one another in it."""


class CovariateShape(StrEnum):
    """How a residual may depend on a covariate."""

    SMOOTH = "smooth"
    SINCE = "since"
    """Time since an event, after which things settle: finer the nearer, and as much as the event was large."""
    PERIODIC = "periodic"
    """An angle [rad]."""
    CATEGORY = "category"
    """Numbers that only name, such as a trial or a wall."""


@dataclass(frozen=True)
class Covariate:
    """A quantity on which a residual may depend; from inputs or a prediction, never from the channel under test."""

    name: str
    values: Array
    """(n,), NaN where it is not known."""
    shape: CovariateShape = CovariateShape.SMOOTH
    second: Array | None = None
    """(n,), the other coordinate where the covariate is a place in a plane."""
    labels: tuple[str, ...] = ()
    """Of the categories 0, 1, ..., where they have names."""
    size: Array | None = None
    """(n,), signed, of the event since which a time is counted, or of what turns: the larger, the more shows."""
    beside: str = ""
    """Name of the covariate with which it acts together: what depends on the value before depends on the one now."""


@dataclass(frozen=True)
class Observed:
    """One measured quantity that a stage predicts, its n samples in the order of trials and time."""

    name: str
    """Unique in a measurement, such as `current_A` or `wheel_left_rad_s`."""
    channel: str
    """By which an answer speaks of it, such as `wheel_speed_rad_s` of both wheels."""
    unit: str
    values: Array
    """(n,); NaN where not usable."""
    sd: Array
    """(n,), standard deviation of the noise of a good sample by the nominal robot."""
    correlation: float | None
    """Of the noise of a sample with that of the next; None where nobody knows, to be found from what a model leaves."""
    trial: NDArray[np.int64]
    """(n,), index of the trial in the measurement."""
    t_s: Array
    """(n,), since the trial began."""
    holdout: Mask
    """(n,)."""
    usable: Mask
    """(n,), false for missing samples and codes, and where the nominal prediction is not one-valued."""
    covariates: tuple[Covariate, ...] = field(default=())
    resolution: float = 0.0
    """Step to which the values are rounded, in their unit; 0 where none is known."""
    noise_is_stated: bool = True
    """Whether `sd` and `correlation` are the source's; else they are a guess, to be found from what a model leaves."""

    def __post_init__(self) -> None:
        rows = len(self.values)
        arrays = (self.sd, self.trial, self.t_s, self.holdout, self.usable, *(c.values for c in self.covariates))
        if any(array.shape != (rows,) for array in arrays):
            raise ValueError(f"{self.name}: arrays of {[array.shape for array in arrays]} for {rows} samples")


@dataclass(frozen=True)
class Predicted:
    """Of one observed quantity, by M robots."""

    mean: Array
    """(M, n); NaN where an input misses."""
    sd: Array
    """(M, n) or broadcast to it: standard deviation of the noise, which some effects change."""


class Stage(Protocol):
    """One link, bound to a measurement."""

    name: str
    """`motor`, `wheels`, `pose`, `tof`."""
    observed: tuple[Observed, ...]
    at_once: int
    """Robots in one pass: more of them save nothing and take memory."""

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        """One for each observed quantity, in their order, by robots that may differ in numbers and in effects."""
        ...


Binder = Callable[[Measurement, RobotConfig], tuple[Stage, ...]]
"""The stages of a measurement, along the signal chain; the robot is the nominal one."""
