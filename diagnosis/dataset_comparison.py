"""A dataset compared with a measured drive: what the dataset covers of what the real robot did and saw.

Two things are compared. The *signals*, such as speeds, voltages and ranges: their distributions show whether the
dataset went where the robot went. And the *residuals* of one nominal robot in both, stage by stage, where each stage
is driven by what was logged at its input: their median shows how far a robot is from the nominal one, their scatter
shows the noise. A dataset that draws another robot for each run covers a real robot if the real robot's median lies
among those of the runs.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.predictors import STAGES
from symolo.core.arrays import Array
from symolo.core.errors import InputError

CHANNELS = ("u_left_V", "u_right_V", "tof_front_m", "tof_left_m", "tof_right_m")
"""Channels that are compared as logged, in addition to what the stages observe."""
MIN_SAMPLES = 10
"""Smallest number of samples for a comparison."""
BLOCKS = 12
"""Blocks of a log whose medians give the standard error of its median."""
MAX_STANDARD_ERRORS = 2.0
"""Standard errors by which a median may lie outside those of the runs."""
MAX_OUTSIDE = 0.02
"""Share of the samples of a quantity that may lie outside the dataset's range."""
SCATTER_RATIOS = (0.5, 2.0)
"""Range of the measured scatter, relative to that of the runs, that counts as similar."""
MAD_TO_SD = 1.4826
"""Standard deviation of normal noise over its median absolute deviation."""


@dataclass(frozen=True)
class QuantityComparison:
    """One quantity of the measured log and of each run of the dataset."""

    name: str
    unit: str
    measured: Array
    """Measured samples, (n,)."""
    runs: tuple[Array, ...]
    """Samples of each run, (n,) each."""

    @cached_property
    def pooled(self) -> Array:
        """Samples of all runs together."""
        return np.concatenate(self.runs)

    @property
    def outside(self) -> float:
        """Share of the measured samples outside the range of the dataset's samples."""
        low, high = self.pooled.min(), self.pooled.max()
        return float(np.mean((self.measured < low) | (self.measured > high)))

    @property
    def apart(self) -> float:
        """Largest difference of the two distribution functions (Kolmogorov and Smirnov), 0 to 1."""
        both = np.sort(np.concatenate([self.measured, self.pooled]))
        shares = (np.searchsorted(np.sort(x), both, side="right") / len(x) for x in (self.measured, self.pooled))
        return float(np.max(np.abs(np.subtract(*shares))))

    @property
    def is_covered(self) -> bool:
        return self.outside <= MAX_OUTSIDE


@dataclass(frozen=True)
class ResidualComparison(QuantityComparison):
    """Residuals of a quantity, measured minus predicted by the nominal robot."""

    @property
    def middle(self) -> float:
        return float(np.median(self.measured))

    @property
    def middles(self) -> tuple[float, ...]:
        return tuple(float(np.median(run)) for run in self.runs)

    @property
    def scatter(self) -> float:
        return scatter(self.measured)

    @property
    def scatters(self) -> tuple[float, ...]:
        return tuple(scatter(run) for run in self.runs)

    @property
    def error(self) -> float:
        """Standard error of the measured median."""
        # The noise of neighbouring samples may be correlated, so the error comes from the medians of blocks.
        blocks = min(BLOCKS, len(self.measured) // 3)
        middles = [float(np.median(part)) for part in np.array_split(self.measured, blocks)]
        return float(np.std(middles, ddof=1)) / blocks**0.5

    @property
    def is_covered(self) -> bool:
        slack = MAX_STANDARD_ERRORS * self.error
        return min(self.middles) - slack <= self.middle <= max(self.middles) + slack

    @property
    def scatters_alike(self) -> bool:
        low, high = min(self.scatters), max(self.scatters)
        return SCATTER_RATIOS[0] * low <= self.scatter <= SCATTER_RATIOS[1] * high


@dataclass(frozen=True)
class DatasetComparison:
    """The comparison of a dataset with a measured drive."""

    release: str
    runs: tuple[str, ...]
    signals: tuple[QuantityComparison, ...]
    residuals: tuple[ResidualComparison, ...]


def scatter(values: Array) -> float:
    """Return the standard deviation of normal values, estimated from the median of their absolute deviations."""
    return MAD_TO_SD * float(np.median(np.abs(values - np.median(values))))


def compare_with_dataset(measured: Measurement, release: Measurement, nominal: RobotConfig) -> DatasetComparison:
    """Compare a dataset with a measured drive.

    Args:
        measured: A drive of a real robot.
        release: All runs of the dataset, or one.
        nominal: The robot that predicts both.

    Raises:
        InputError: One of them is no drive, or they have no quantity in common.
    """
    check_drive(measured, "CASE")
    check_drive(release, "--against")
    measured_samples, release_samples = dict(_samples(measured, nominal)), dict(_samples(release, nominal))
    signals, residuals = [], []
    for name, ours in measured_samples.items():
        if name not in release_samples or len(values := np.concatenate(ours.values)) < MIN_SAMPLES:
            continue
        theirs = release_samples[name]
        usable = [k for k, run in enumerate(theirs.values) if len(run) >= MIN_SAMPLES]
        if not usable:
            continue
        signals.append(QuantityComparison(name, ours.unit, values, tuple(theirs.values[k] for k in usable)))
        if ours.residuals is not None and theirs.residuals is not None:
            runs = tuple(theirs.residuals[k] for k in usable)
            residuals.append(ResidualComparison(name, ours.unit, np.concatenate(ours.residuals), runs))
    if not signals:
        raise InputError(
            "has no quantity in common with the measured log", where=release.name, cure="name another dataset"
        )
    return DatasetComparison(
        release.name, tuple(trial.name for trial in release.trials), tuple(signals), tuple(residuals)
    )


def check_drive(measurement: Measurement, argument: str) -> None:
    """Raise InputError if a measurement is no drive, so that it cannot be compared with a dataset."""
    if measurement.kind is not CaseKind.DRIVE_LOG:
        cure = "name a log of a driving robot; a dataset has no data of a motor or sensor on a bench"
        what = f"{argument} is data of kind {measurement.kind}"
        raise InputError(what, where=measurement.name, allowed=CaseKind.DRIVE_LOG, cure=cure)


@dataclass(frozen=True)
class _Samples:
    """Samples of one quantity, by trial."""

    unit: str
    values: list[Array]
    residuals: list[Array] | None
    """Measured minus predicted; None if no stage predicts the quantity."""


def _samples(measurement: Measurement, nominal: RobotConfig) -> Iterator[tuple[str, _Samples]]:
    for stage in STAGES[measurement.kind](measurement, nominal):
        for observed, predicted in zip(stage.observed, stage.predict([nominal]), strict=True):
            if observed.name in CHANNELS:
                continue
            residuals = observed.values - predicted.mean[0]
            usable = observed.usable & np.isfinite(residuals)
            rows = [usable & (observed.trial == k) for k in range(len(measurement.trials))]
            yield (
                observed.name,
                _Samples(observed.unit, [observed.values[r] for r in rows], [residuals[r] for r in rows]),
            )
    logged = set(measurement.channel_names())
    for name in CHANNELS:
        if name in logged:
            channels = measurement.across(name)
            yield name, _Samples(channels[0].unit, [channel.values[channel.good] for channel in channels], None)
