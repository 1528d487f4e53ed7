"""A measurement: trials of one robot, or of a part of it, with source, clocks and nominal parameters."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from configs.schema.arena import ArenaConfig
from diagnosis.measured.case_files.nominal import Nominal
from diagnosis.measured.channel import Channel, Label, Mask
from symolo.core.arrays import Array
from symolo.core.tables.time_series import TimeSeries
from symolo.core.text_enum import TextEnum

CHECK = "CHECK"
"""First word of each note about data that are probably wrong, so that a user has to check them."""
CHECK_UNIT = f"{CHECK} THE UNIT"
"""First words of each note about a column that is probably in another unit."""


class CaseKind(TextEnum):
    """Kinds of measurement, each of which has its own prediction."""

    MOTOR_STEADY = "motor_steady"
    """Steady states of a motor, each row at one voltage."""
    MOTOR_STEP = "motor_step"
    """Voltage, current and speed of a motor against time."""
    TOF_BENCH = "tof_bench"
    """Readings of a range sensor at known distances."""
    RANGE_SCAN = "range_scan"
    """Readings of a range sensor that was moved past an object."""
    DRIVE_LOG = "drive_log"
    """Voltages, encoder counts, ranges and pose of a robot with two driven wheels."""
    SYMOLO_CSV = "symolo_csv"
    """Rows of a SyMoLo data.csv, in an arena that is known: pose, speeds, ranges and line readings."""
    TOGETHER = "together"
    """Several cases of one robot (`diagnosis.together`)."""
    OTHER = "other"
    """Channels that no stage of the simulator predicts, but from which noise, delays and time constants follow."""


@dataclass(frozen=True)
class MeasurementSource:
    """Origin of the data."""

    origin: str
    """Who measured what, in one line."""
    files: tuple[str, ...]
    """Paths as the user would type them; empty for tables that are printed in a paper."""
    licence: str = ""
    """Licence of the data; empty for data of the user."""


@dataclass(frozen=True)
class Trial:
    """One log without interruption, or one sweep on a bench, with N rows."""

    name: str
    t_s: Array
    """(N,), strictly increasing time since the trial began; row numbers if the time was not logged."""
    holdout: Mask
    """(N,), rows that must not be used to select or fit anything."""
    channels: tuple[Channel, ...]
    labels: tuple[Label, ...] = ()
    begins_s: float | None = None
    """Time of `t_s` = 0 since the session began; None if it was not logged."""
    is_timed: bool = True
    """Whether `t_s` are times."""
    part: str = ""
    """Part of the robot that was measured; empty if it is the same in all trials."""
    held_inputs: tuple[TimeSeries, ...] = ()
    """Inputs that also change between the rows, by the names of their channels: each value is held from its time to the
    next, and the channel has the mean from row to row. Empty if they change at rows only, or as far as is known."""
    session: str = ""
    """Session in which the trial was driven: between sessions, markers and clocks are set again. Empty if not known."""
    arena: ArenaConfig | None = None
    """Arena of a simulated trial, whose poses are exact; None for any other trial, or if the data do not state it."""

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
    """The trials of one robot or test bench, with their source and nominal parameters."""

    name: str
    kind: CaseKind
    source: MeasurementSource
    trials: tuple[Trial, ...]
    """Trials, at least one, with the same channels in the same order."""
    nominal: Nominal | None = None
    """Parameters of a textbook simulation; None if none came with the data."""
    notes: tuple[str, ...] = ()
    """Notes for a user of the data, such as what is missing and how codes were interpreted."""
    compared_with: str = ""
    """Sentence on the robot that the data are compared with, if they state none themselves."""
    cases: "tuple[Measurement, ...]" = ()
    """Cases of kind TOGETHER, whose trials follow each other without their channels; empty for any other kind."""

    def __post_init__(self) -> None:
        if not self.trials:
            raise ValueError(f"measurement {self.name}: no trial")
        names = [tuple((channel.name, channel.unit) for channel in trial.channels) for trial in self.trials]
        if len(set(names)) > 1:
            raise ValueError(f"measurement {self.name}: the trials have different channels")

    @property
    def where(self) -> str:
        """Return the place of the data for a message: the first file, or the name if there is no file."""
        return next(iter(self.source.files), self.name)

    @property
    def rows(self) -> int:
        return sum(len(trial.t_s) for trial in self.trials)

    @property
    def checks(self) -> tuple[str, ...]:
        """Notes about what is probably wrong in the data."""
        return tuple(note for note in self.notes if note.startswith(CHECK))

    def has(self, *names: str) -> bool:
        """Return whether all of these channels were logged."""
        return self._logged.issuperset(names)

    @cached_property
    def _logged(self) -> frozenset[str]:
        """Names of the channels with a sample in any trial; one look at each of thousands of trials."""
        return frozenset(channel.name for trial in self.trials for channel in trial.channels if channel.is_offered)

    @property
    def heldout_rows(self) -> int:
        return sum(int(np.count_nonzero(trial.holdout)) for trial in self.trials)

    def across(self, name: str) -> tuple[Channel, ...]:
        """Return one channel in every trial."""
        return tuple(trial[name] for trial in self.trials)

    def channel_names(self) -> Iterator[str]:
        return (channel.name for channel in self.trials[0].channels)
