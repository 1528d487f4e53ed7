"""The result of `symolo inspect --json`."""

from diagnosis.measured.overview import ChannelSummary, LogSummary, TrialSummary
from pipeline.json_results.base import JsonPart, JsonResult


class TrialPart(JsonPart):
    """Rows and times of one trial of the measurement."""

    name: str
    """Name of the trial."""
    rows: int
    """Number of rows."""
    held_out: int
    """Number of rows that a diagnosis does not fit, but uses to judge the result."""
    begins_s: float | None
    """Time of the first row on the clock of the log; null where it has none."""
    lasts_s: float | None
    """Duration; null, as the next three keys, for rows that are no time series."""
    rate_hz: float | None
    """Rate of the rows."""
    gaps: int | None
    """Number of gaps between the rows."""
    longest_s: float | None
    """Longest time between two rows."""

    @classmethod
    def from_summary(cls, trial: TrialSummary) -> "TrialPart":
        return cls.model_validate(trial, from_attributes=True)


class NoisePart(JsonPart):
    """Noise of one channel, estimated from its readings."""

    text: str
    """The noise as the command prints it without --json."""
    sd: float | None
    """Standard deviation; null where it is not known."""
    in_known: bool
    """Whether the unit of sd is the noise that the source states; otherwise it is that of the channel."""
    correlation: float | None
    """Correlation from row to row; null for repeated measurements."""
    repeats: int | None
    """Number of repeated measurements; null for a time series."""


class ChannelPart(JsonPart):
    """One measured quantity: how many rows have it, how good they are, and its range of values."""

    name: str
    """Name of the channel, with its unit."""
    unit: str
    """Unit of the values; empty for numbers without one."""
    role: str
    """input: what was done to the robot; reading: what was measured."""
    rows: int
    """Number of rows."""
    missing: int
    """Number of rows without a value."""
    no_target: int
    """Number of rows in which a range sensor saw no target."""
    stale: int
    """Number of rows that repeat an old value."""
    outliers: int
    """Number of rows far from their neighbours, or from the known distance."""
    min: float | None
    """Smallest good value; null where there is none."""
    max: float | None
    """Largest good value; null where there is none."""
    step: float | None
    """Quantisation step; null where none shows."""
    noise: NoisePart
    """Noise that was estimated from the data."""
    known: str
    """Noise that the source states, as text; - where it states none."""

    @classmethod
    def from_summary(cls, channel: ChannelSummary) -> "ChannelPart":
        return cls(
            name=channel.name,
            unit=channel.unit,
            role=channel.role,
            rows=channel.rows,
            missing=channel.missing,
            no_target=channel.no_target,
            stale=channel.stale,
            outliers=channel.outliers,
            min=channel.low,
            max=channel.high,
            step=channel.step,
            noise=NoisePart.model_validate(channel.noise, from_attributes=True),
            known=channel.known,
        )


class InspectResult(JsonResult):
    """What the log of a real robot or test bench contains."""

    command: str = "inspect"
    """Name of the command."""
    name: str
    """Name of the case."""
    kind: str
    """Kind of the case, such as drive_log."""
    rows: int
    """Number of rows of all trials."""
    held_out: int
    """Number of rows that a diagnosis does not fit, but uses to judge the result."""
    source: str
    """Origin of the data."""
    licence: str
    """Licence of the data; empty where the source states none."""
    files: list[str]
    """Files that were read."""
    has_nominal: bool
    """Whether nominal parameters came with the data."""
    trials: list[TrialPart]
    """Trials in their order."""
    channels: list[ChannelPart]
    """Channels in their order, over all trials."""
    labels: dict[str, list[str]]
    """Words that occur in each label, such as the materials of a bench."""
    clocks: dict[str, list[str]]
    """Names of the channels by their clock."""
    notes: list[str]
    """Notes about the data."""

    @classmethod
    def from_summary(cls, summary: LogSummary) -> "InspectResult":
        return cls(
            name=summary.name,
            kind=summary.kind,
            rows=summary.rows,
            held_out=summary.held_out,
            source=summary.origin,
            licence=summary.licence,
            files=list(summary.files),
            has_nominal=summary.has_nominal,
            trials=[TrialPart.from_summary(trial) for trial in summary.trials],
            channels=[ChannelPart.from_summary(channel) for channel in summary.channels],
            labels={name: list(words) for name, words in summary.labels.items()},
            clocks={name: list(channels) for name, channels in summary.clocks.items()},
            notes=list(summary.notes),
        )
