"""A measurement: trials of one robot, or of a part of it, with source, clocks and nominal parameters."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Channel, Label, Mask
from diagnosis.measured.nominal import Nominal
from symolo.core.arrays import Array
from symolo.core.text_enum import TextEnum


class CaseKind(TextEnum):
    """What a measurement is of, and hence which prediction belongs to it."""

    MOTOR_STEADY = "motor_steady"
    """Rows are steady states of a motor at one voltage each."""
    MOTOR_STEP = "motor_step"
    """Voltage, current and speed of a motor against time."""
    TOF_BENCH = "tof_bench"
    """Readings of a range sensor at known distances."""
    DRIVE_LOG = "drive_log"
    """Voltages, encoder counts, ranges and pose of a robot with two driven wheels."""
    OTHER = "other"
    """Channels that no stage of the simulator predicts as they are; for noise, delays and time constants."""


@dataclass(frozen=True)
class MeasurementSource:
    """Where the data come from."""

    origin: str
    """Who measured what, in a line."""
    files: tuple[str, ...]
    """As the user would type them; empty for what is printed in a paper."""
    licence: str = ""
    """Empty where it is the user's own."""


@dataclass(frozen=True)
class Trial:
    """One log without interruption, or one sweep on a bench. All arrays have its N rows."""

    name: str
    t_s: Array
    """(N,), strictly increasing, since the trial began; row numbers where nobody noted the time."""
    holdout: Mask
    """(N,), rows that must not be used to choose or fit anything."""
    channels: tuple[Channel, ...]
    labels: tuple[Label, ...] = ()
    begins_s: float | None = None
    """Time of `t_s` = 0 since the session began, where it was noted."""
    is_timed: bool = True
    """Whether `t_s` are times."""
    part: str = ""
    """Which part of the robot it is of, where the trials differ in that."""

    def __post_init__(self) -> None:
        rows = len(self.t_s)
        lengths = {channel.name: len(channel.values) for channel in self.channels}
        lengths |= {label.name: len(label.values) for label in self.labels} | {"holdout": len(self.holdout)}
        wrong = {name: length for name, length in lengths.items() if length != rows}
        if wrong:
            raise ValueError(f"trial {self.name}: {rows} rows, but {wrong}")
        self.t_s.flags.writeable = False
        self.holdout.flags.writeable = False

    def __getitem__(self, name: str) -> Channel:
        for channel in self.channels:
            if channel.name == name:
                return channel
        raise KeyError(f"no channel {name!r}; there are {', '.join(channel.name for channel in self.channels)}")

    def label(self, name: str) -> Label:
        for label in self.labels:
            if label.name == name:
                return label
        raise KeyError(f"no label {name!r}; there are {', '.join(label.name for label in self.labels)}")


@dataclass(frozen=True)
class Measurement:
    name: str
    kind: CaseKind
    source: MeasurementSource
    trials: tuple[Trial, ...]
    """At least one; all have the same channels in the same order."""
    nominal: Nominal | None = None
    """Parameters of a textbook simulation of it, where they came with the data."""
    notes: tuple[str, ...] = ()
    """What a user of the data should know, a sentence each: what is missing, what was taken for what."""

    def __post_init__(self) -> None:
        if not self.trials:
            raise ValueError(f"measurement {self.name}: no trial")
        names = [tuple((channel.name, channel.unit) for channel in trial.channels) for trial in self.trials]
        if len(set(names)) > 1:
            raise ValueError(f"measurement {self.name}: the trials have different channels")

    @property
    def rows(self) -> int:
        return sum(len(trial.t_s) for trial in self.trials)

    @property
    def heldout_rows(self) -> int:
        return sum(int(np.count_nonzero(trial.holdout)) for trial in self.trials)

    def across(self, name: str) -> tuple[Channel, ...]:
        """One channel in every trial."""
        return tuple(trial[name] for trial in self.trials)

    def channel_names(self) -> Iterator[str]:
        return (channel.name for channel in self.trials[0].channels)
