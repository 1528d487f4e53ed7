"""A dataset held against a measured drive: what it covers of what the real robot did and saw, and of how it differs.

Two things are compared. What is *seen*: speeds, ways, voltages and ranges, whose distributions say whether the dataset
went where the robot went. And what one and the same textbook robot *leaves* of both, stage by stage, each stage driven
by what was logged at its input: its middle is how far a robot is from the textbook, its scatter the noise. A dataset
whose robots are drawn from run to run covers a real one if that one's middle lies among those of the runs.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Kind, Measurement
from diagnosis.predictors import STAGES
from symolo.core.arrays import Array
from symolo.core.errors import InputError

CHANNELS = ("u_left_V", "u_right_V", "tof_front_m", "tof_left_m", "tof_right_m")
"""That are compared as they are, beside what the stages observe."""
FEW = 10
"""Samples, below which nothing is compared."""
BLOCKS = 12
"""Stretches of a log whose middles say how sure its middle is."""
SURE = 2.0
"""Standard errors by which a middle may lie beyond those of the runs."""
OUTSIDE = 0.02
"""Share of samples beyond all of the dataset's, from which a quantity is said to leave it."""
WIDER = (0.5, 2.0)
"""Times the scatter of the runs, within which that of the measured log is alike."""
TO_SIGMA = 1.4826
"""Standard deviation over the median of absolute deviations, of normal noise."""


@dataclass(frozen=True)
class Compared:
    """One quantity, of the measured log and of each run of the dataset."""

    name: str
    unit: str
    measured: Array
    """(n,)."""
    runs: tuple[Array, ...]
    """(n,) each."""

    @cached_property
    def pooled(self) -> Array:
        """Of all runs."""
        return np.concatenate(self.runs)

    @property
    def outside(self) -> float:
        """Share of the measured samples that lie beyond all of the dataset's."""
        low, high = self.pooled.min(), self.pooled.max()
        return float(np.mean((self.measured < low) | (self.measured > high)))

    @property
    def apart(self) -> float:
        """Largest difference of the two distribution functions (Kolmogorov and Smirnov), 0 to 1."""
        both = np.sort(np.concatenate([self.measured, self.pooled]))
        shares = (np.searchsorted(np.sort(of), both, side="right") / len(of) for of in (self.measured, self.pooled))
        return float(np.max(np.abs(np.subtract(*shares))))

    @property
    def is_covered(self) -> bool:
        return self.outside <= OUTSIDE


@dataclass(frozen=True)
class Left(Compared):
    """What the textbook robot leaves of a quantity, measured less predicted."""

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
        """Standard error of the measured middle, by stretches of the log, in which noise may last."""
        blocks = min(BLOCKS, len(self.measured) // 3)
        middles = [float(np.median(part)) for part in np.array_split(self.measured, blocks)]
        return float(np.std(middles, ddof=1)) / blocks**0.5

    @property
    def is_covered(self) -> bool:
        slack = SURE * self.error
        return min(self.middles) - slack <= self.middle <= max(self.middles) + slack

    @property
    def scatters_alike(self) -> bool:
        low, high = min(self.scatters), max(self.scatters)
        return WIDER[0] * low <= self.scatter <= WIDER[1] * high


@dataclass(frozen=True)
class Against:
    release: str
    runs: tuple[str, ...]
    seen: tuple[Compared, ...]
    left: tuple[Left, ...]


def scatter(values: Array) -> float:
    """Standard deviation of normal values, by the median of their deviations."""
    return TO_SIGMA * float(np.median(np.abs(values - np.median(values))))


def against(measured: Measurement, release: Measurement, textbook: RobotConfig) -> Against:
    """Hold a dataset against a measured drive.

    Args:
        measured: Of a real robot.
        release: All runs of the dataset, or one.
        textbook: The robot by which both are predicted.

    Raises:
        InputError: One of them is no drive, or there is nothing that both have.
    """
    check_drive(measured, "CASE")
    check_drive(release, "--against")
    ours, theirs = (_samples(of, textbook) for of in (measured, release))
    seen, left = [], []
    for name, (unit, values, rest) in ours.items():
        if name not in theirs or len(joined := np.concatenate(values)) < FEW:
            continue
        of_runs, rest_of_runs = theirs[name][1:]
        kept = [k for k, run in enumerate(of_runs) if len(run) >= FEW]
        if not kept:
            continue
        seen.append(Compared(name, unit, joined, tuple(of_runs[k] for k in kept)))
        if rest is not None and rest_of_runs is not None:
            left.append(Left(name, unit, np.concatenate(rest), tuple(rest_of_runs[k] for k in kept)))
    if not seen:
        raise InputError("has nothing that the measured log has", where=release.name, cure="name another dataset")
    return Against(release.name, tuple(trial.name for trial in release.trials), tuple(seen), tuple(left))


def check_drive(measurement: Measurement, argument: str) -> None:
    """Raise InputError where a measurement is no drive, and so not to be held against a dataset."""
    if measurement.kind is not Kind.DRIVE_LOG:
        cure = "name a log of a driving robot; a dataset says nothing of a bench"
        what = f"{argument} is data of kind {measurement.kind}"
        raise InputError(what, where=measurement.name, allowed=Kind.DRIVE_LOG, cure=cure)


Samples = tuple[str, list[Array], list[Array] | None]
"""Unit; of each trial the values; and what the textbook robot leaves of them, where a stage predicts them."""


def _samples(of: Measurement, textbook: RobotConfig) -> dict[str, Samples]:
    """By name."""
    return dict([*_predicted(of, textbook), *_logged(of)])


def _predicted(of: Measurement, textbook: RobotConfig) -> Iterator[tuple[str, Samples]]:
    for stage in STAGES[of.kind](of, textbook):
        for observed, predicted in zip(stage.observed, stage.predict([textbook]), strict=True):
            if observed.name in CHANNELS:
                continue
            off = observed.values - predicted.mean[0]
            rows = observed.usable & np.isfinite(off)
            trials = range(len(of.trials))
            values = [observed.values[rows & (observed.trial == k)] for k in trials]
            yield observed.name, (observed.unit, values, [off[rows & (observed.trial == k)] for k in trials])


def _logged(of: Measurement) -> Iterator[tuple[str, Samples]]:
    offered: Sequence[str] = tuple(of.channel_names())
    for name in CHANNELS:
        if name in offered:
            channels = of.across(name)
            yield name, (channels[0].unit, [c.values[c.good] for c in channels], None)
