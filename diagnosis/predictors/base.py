"""The interface of a stage: one link of the signal chain, simulated from what was *measured* at its input.

A wrong motor then does not spoil the poses, errors do not add up along a drive, and the stage at which measurement and
prediction differ shows where the fault is. The stages use the simulator's own models, so that a diagnosis finds a fault
of the robot and not of a second model.

A stage belongs to one measurement: it holds what was observed, flat over all trials, and predicts the same samples by
any number of robots at once, since a fit needs thousands of predictions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.turning_response import TurningResponse
from diagnosis.predictors.wheels.count_noise import CountNoise
from diagnosis.predictors.wheels.early_voltages import EarlyVoltages
from symolo.core.arrays import Array
from symolo.core.text_enum import TextEnum

ROW_TIME = "t_s"
"""Name of the covariate with the time of a row, in which the rows of a trial are in order."""
SESSION_TIME = "session_time_s"
"""Name of the covariate with the time since the session began."""


class CovariateShape(TextEnum):
    """Ways in which a residual may depend on a covariate."""

    SMOOTH = "smooth"
    SINCE = "since"
    """Time since an event: the dependence is finer near the event and in proportion to its size."""
    PERIODIC = "periodic"
    """Dependence on an angle [rad]."""
    CATEGORY = "category"
    """Numbers that are only names, such as that of a trial or a wall."""
    EVENT = "event"
    """Size of an event with a sign, 0 where there is none. Events that are large enough have the same consequence."""
    COMPUTED = "computed"
    """Dependence by functions that the stage computes (`functions`), of which one at most is right."""
    OUTLINE = "outline"
    """Place along a closed outline with corners, such as the walls of a room."""


@dataclass(frozen=True)
class Covariate:
    """A quantity on which a residual may depend, from inputs or a prediction and never from the tested channel."""

    name: str
    values: Array
    """(n,), NaN where the value is not known."""
    shape: CovariateShape = CovariateShape.SMOOTH
    second: Array | None = None
    """(n,), second coordinate of a place in a plane; None for other covariates."""
    labels: tuple[str, ...] = ()
    """Names of the categories 0, 1, ..., if they have names."""
    size: Array | None = None
    """(n,), signed size of the event since which a time is counted, or of what moves; the effect grows with it."""
    beside: str = ""
    """Name of a covariate that acts together with this one, as the current value does with the previous one."""
    response: TurningResponse | None = None
    """Response of the quantity to a torque that depends on this angle; None if this is no angle of a shaft."""
    levels: Array | None = None
    """(n, k), number of events that reach each of k sizes, those of the other sign subtracted; None for no events."""
    functions: tuple[Array, ...] = ()
    """Sets of functions that are tested one by one, (n, k) each; the values are only for plots."""
    functions_are: str = "functions"
    """What these functions are, for reports."""
    corners: tuple[float, ...] = ()
    """Places of the corners of an outline in rising order, with its start and its end, which are the same corner. A
    dependence may jump there."""
    max_waves: float = 40.0
    """Largest number of waves within its range that are looked for."""
    as_rate: "tuple[str, Array] | None" = None
    """Name of the rate, and the duration [s] (n,) by which this is divided to get it; None if it is no change."""


@dataclass(frozen=True)
class SharedReading:
    """A logged reading that a sample adds and a later one subtracts, so that its noise is in both with opposite signs.

    It makes the sum of many samples more certain, but structure that turns over between the two samples less so.
    """

    later: int
    """Number of samples of a trial after which the reading is subtracted."""
    correlation: Array
    """(n,), correlation of the noise of a sample with that of the later one."""


@dataclass(frozen=True)
class InputResponse:
    """An error which no effect of the list describes, such as one of the input, and how a quantity responds to it."""

    covariate: str
    """Name of the covariate with the input, or of the time over which the error drifts."""
    what: str
    """Description for reports, such as `gain of the voltage`."""
    response: Array
    """(n,), change of the prediction by a small error, in any unit that the quantities of a stage share."""
    chosen: int = 0
    """Numbers that are chosen for it, such as a threshold of which several are tried."""


@dataclass(frozen=True)
class SharedFunctions:
    """Functions of a covariate that all quantities of a stage share, and how one quantity responds to them."""

    covariate: str
    """Name of the covariate."""
    what: str
    """Description for reports, such as `patches`."""
    responses: Callable[[], Array] = field(compare=False, repr=False)
    """Function that returns the changes (n, k) of the prediction by each function, in any unit that the quantities
    share."""
    places: Array = field(compare=False, repr=False)
    """(n, 2), x and y [m] to which each sample belongs, for plots."""


@dataclass(frozen=True)
class Observed:
    """One measured quantity that a stage predicts, with n samples in the order of trials and time."""

    name: str
    """Unique name in a measurement, such as `current_A` or `wheel_left_rad_s`."""
    channel: str
    """Name in an answer, such as `wheel_speed_rad_s` for both wheels."""
    unit: str
    values: Array
    """(n,), measured values; NaN where not usable."""
    sd: Array
    """(n,), standard deviation of the noise of a good sample, by the nominal robot."""
    correlation: float | None
    """Correlation of the noise of successive samples; None if it must be estimated from the residuals."""
    correlation_at_most: float = field(default=1.0, kw_only=True)
    """Largest correlation that an estimate may give."""
    shared: SharedReading | None = field(default=None, kw_only=True)
    """The reading that samples share with later ones; None if there is none."""
    readings: int = field(default=1, kw_only=True)
    """Number of logged readings that a sample consists of, each of which may be an outlier."""
    trial: NDArray[np.int64]
    """(n,), index of the trial."""
    t_s: Array
    """(n,), time since the start of the trial."""
    holdout: Mask
    """(n,), samples that are held out."""
    usable: Mask
    """(n,), false for missing samples and codes, and where the nominal prediction is ambiguous."""
    covariates: tuple[Covariate, ...] = field(default=())
    resolution: float = 0.0
    """Step to which the values are rounded, in their unit; 0 if it is not known."""
    noise_is_stated: bool = True
    """Whether the source states `sd`; else it is a guess, and the noise is estimated from the residuals."""
    is_series: bool = True
    """Whether successive rows follow each other in time. The rows of a sweep are separate states: what neighbours have
    in common is misfit, and never correlated noise."""
    samples: str = "rows"
    """What the samples are, in the plural: the rows of the log, a part of them, or windows of several rows."""
    input_errors: tuple[InputResponse, ...] = ()
    """Possible errors of the input; all quantities of a stage have the same ones in the same order."""
    shared_functions: tuple[SharedFunctions, ...] = ()
    """Functions against which all quantities of a stage are tested together; all have the same ones in the same
    order."""
    numbers_may_drift: bool = False
    """Whether drifts of the nominal numbers over the session compete with the effects."""
    count_noise: CountNoise | None = field(default=None, compare=False, repr=False)
    """Noise of speeds that are computed from counts; None if the noise is that of `sd` and `correlation` alone."""
    early: EarlyVoltages | None = None
    """Responses to voltages that act before they are logged; None if the quantity follows no voltage."""
    is_state: Mask | None = None
    """(n,), samples of which only a state is known, such as that a motor stands still. Their residual is what the state
    says against the model, and no error in the unit of the quantity. None if there are none."""

    def __post_init__(self) -> None:
        rows = len(self.values)
        arrays = (self.sd, self.trial, self.t_s, self.holdout, self.usable, *(c.values for c in self.covariates))
        if self.shared is not None:
            arrays = (*arrays, self.shared.correlation)
        if any(array.shape != (rows,) for array in arrays):
            raise ValueError(f"{self.name}: arrays of {[array.shape for array in arrays]} for {rows} samples")


@dataclass(frozen=True)
class Predicted:
    """Predictions of one observed quantity by M robots."""

    mean: Array
    """(M, n), NaN where an input is missing."""
    sd: Array
    """(M, n) or broadcast to it, standard deviation of the noise, which some effects change."""
    by_tolerances: Array | None = None
    """(M,), part of the squares of all residuals in sigmas that comes from numbers which leave their tolerances, if the
    stage finds the best ones itself; None for 0."""


class Stage(Protocol):
    """One link of the signal chain of a measurement."""

    name: str
    """Name of the stage: `motor`, `wheels`, `pose` or `tof`."""
    observed: tuple[Observed, ...]
    at_once: int
    """Number of robots in one pass; more would need memory and save no time."""

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        """Return the predictions of each observed quantity, in order; robots may differ in numbers and effects."""
        ...


Binder = Callable[[Measurement, RobotConfig], tuple[Stage, ...]]
"""Function that returns the stages of a measurement along the signal chain, with the nominal robot."""


def only_stage(stage: Callable[[Measurement, RobotConfig], Stage]) -> Binder:
    """Return the function for a bench, whose signal chain has a single stage."""
    return lambda measurement, nominal: (stage(measurement, nominal),)
