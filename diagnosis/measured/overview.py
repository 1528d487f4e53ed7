"""Content of a log, for `symolo inspect`: trials with rates and gaps; channels with missing samples and noise."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Channel, Mask, Role, SampleQuality
from diagnosis.measured.measurement import CaseKind, Measurement, Trial
from diagnosis.measured.noise import noise_of_repeats
from diagnosis.measured.screening import far_out, noise_of, resolution, spikes, timing, usable
from diagnosis.measured.sweep_noise import noise_of_equal_voltages
from symolo.core.arrays import Array
from symolo.core.progress import plural

SAME_TEMPERATURE_K = 3.0
"""Width of a range of temperatures that counts as one condition."""
NOT_NOTED = -1e9
"""Number that stands for a condition that was not logged, since NaN is not equal to itself."""
MAX_TRIALS = 12
"""Largest number of trials that have a line each."""
_HEAD = (
    "channel",
    "unit",
    "",
    "rows",
    "missing",
    "no target",
    "stale",
    "outliers",
    "from",
    "to",
    "step",
    "noise",
    "known",
)


@dataclass(frozen=True)
class TrialSummary:
    """One trial of a log."""

    name: str
    rows: int
    held_out: int
    """Number of rows that are not fitted."""
    begins_s: float | None
    """Time of its first row on the clock of the log; None where it has none."""
    lasts_s: float | None
    rate_hz: float | None
    gaps: int | None
    longest_s: float | None
    """Longest time between two rows; None, as rate and gaps, for rows that are no time series."""


@dataclass(frozen=True)
class NoiseSummary:
    """The noise that was estimated from the data."""

    text: str
    """Description of the noise, as `symolo inspect` prints it."""
    sd: float | None = None
    """Standard deviation in the unit of the channel, or in that of the stated noise; None where it is not known."""
    correlation: float | None = None
    """Correlation from row to row; None for repeats."""
    repeats: int | None = None
    """Number of repeated measurements; None for a time series."""
    in_known: bool = False
    """Whether the unit of `sd` is the stated noise."""


@dataclass(frozen=True)
class ChannelSummary:
    """One channel of a log, over all trials."""

    name: str
    unit: str
    role: str
    rows: int
    missing: int
    no_target: int
    stale: int
    outliers: int
    low: float | None
    high: float | None
    """Smallest and largest good value; None where there is none."""
    step: float | None
    """Quantisation step; None where none shows."""
    noise: NoiseSummary
    known: str
    """Noise that the source states, as text; `-` where it states none."""


@dataclass(frozen=True)
class LogSummary:
    """What a log contains."""

    name: str
    kind: str
    rows: int
    held_out: int
    origin: str
    licence: str
    files: tuple[str, ...]
    has_nominal: bool
    """Whether nominal parameters came with the data."""
    trials: tuple[TrialSummary, ...]
    channels: tuple[ChannelSummary, ...]
    labels: Mapping[str, Sequence[str]]
    """Words that occur in each label."""
    clocks: Mapping[str, Sequence[str]]
    """Names of the channels by their clock."""
    notes: tuple[str, ...]


def summarise(measurement: Measurement) -> LogSummary:
    """Return what a log contains."""
    first, source = measurement.trials[0], measurement.source
    clocks: dict[str, list[str]] = {}
    for channel in first.channels:
        clocks.setdefault(channel.clock, []).append(channel.name)
    return LogSummary(
        name=measurement.name,
        kind=measurement.kind,
        rows=measurement.rows,
        held_out=measurement.heldout_rows,
        origin=source.origin,
        licence=source.licence,
        files=tuple(source.files),
        has_nominal=measurement.nominal is not None,
        trials=tuple(_trial(trial) for trial in measurement.trials),
        channels=tuple(_channel(measurement, name) for name in measurement.channel_names()),
        labels={
            label.name: sorted({word for trial in measurement.trials for word in trial.label(label.name).values})
            for label in first.labels
        },
        clocks=clocks,
        notes=tuple(measurement.notes),
    )


def overview(measurement: Measurement) -> list[str]:
    """Return the lines of the text."""
    summary = summarise(measurement)
    licence = f" ({summary.licence})" if summary.licence else ""
    lines = [summary_line(measurement), f"source: {summary.origin}{licence}"]
    if summary.files:
        first, *more = summary.files
        lines.append(f"read from {first}{f' and {len(more)} more' if more else ''}")
    if not summary.has_nominal:
        lines.append("nominal parameters: none came with the data")
    lines += measurement.checks
    lines += ["", *_trial_lines(summary), "", *_channel_lines(summary)]
    notes = [note for note in summary.notes if note not in measurement.checks]
    lines += ["", *(f"note: {note}" for note in notes)] if notes else []
    return lines


def summary_line(measurement: Measurement) -> str:
    """Return one line with name, kind, trials and rows."""
    rows, held = measurement.rows, measurement.heldout_rows
    split = f"{rows - held} to fit, {held} held out" if held else "none held out"
    trials = len(measurement.trials)
    return f"{measurement.name}: {measurement.kind}, {plural(trials, 'trial')}, {plural(rows, 'row')} ({split})"


def _trial(trial: Trial) -> TrialSummary:
    steps = timing(trial.t_s) if trial.is_timed else None
    return TrialSummary(
        name=trial.name,
        rows=len(trial.t_s),
        held_out=int(np.count_nonzero(trial.holdout)),
        begins_s=None if trial.begins_s is None else float(trial.begins_s + trial.t_s[0]),
        lasts_s=float(trial.t_s[-1] - trial.t_s[0]) if steps else None,
        rate_hz=float(steps.rate_hz) if steps else None,
        gaps=int(steps.gaps) if steps else None,
        longest_s=float(steps.longest_s) if steps else None,
    )


def _trial_lines(summary: LogSummary) -> Iterator[str]:
    times = f"{'begins, s':>12}{'lasts, s':>11}{'rate, Hz':>10}{'gaps':>6}{'longest, s':>12}"
    yield f"{'trial':28}{'rows':>7}{'held out':>10}{times}"
    for trial in summary.trials[:MAX_TRIALS]:
        begins = "-" if trial.begins_s is None else f"{trial.begins_s:.3f}"
        yield f"{trial.name:28}{trial.rows:>7}{trial.held_out:>10}{begins:>12}{_times(trial)}"
    more = len(summary.trials) - MAX_TRIALS
    if more > 0:
        yield f"and {more} more"


def _times(trial: TrialSummary) -> str:
    if trial.rate_hz is None:
        return f"{'-':>11}{'-':>10}{'-':>6}{'-':>12}"
    return f"{trial.lasts_s:>11.2f}{trial.rate_hz:>10.3g}{trial.gaps:>6}{trial.longest_s:>12.3g}"


def _channel(measurement: Measurement, name: str) -> ChannelSummary:
    across = measurement.across(name)
    first = across[0]
    values = np.concatenate([usable(channel) for channel in across])
    known = values[np.isfinite(values)]
    missing, no_target, stale = (sum(channel.count(quality) for channel in across) for quality in _COUNTED)
    is_reading = first.role is Role.READING
    step = resolution(values)
    return ChannelSummary(
        name=name,
        unit=first.unit,
        role=first.role,
        rows=len(values),
        missing=missing,
        no_target=no_target,
        stale=stale,
        outliers=sum(int(np.count_nonzero(mask)) for mask in _outliers(measurement, name)) if is_reading else 0,
        low=float(known.min()) if len(known) else None,
        high=float(known.max()) if len(known) else None,
        step=float(step) if step else None,
        noise=_noise(measurement, name) if is_reading else NoiseSummary("-"),
        known=_known(across),
    )


def _channel_lines(summary: LogSummary) -> Iterator[str]:
    rows = [_HEAD, *(_cells(channel) for channel in summary.channels)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_HEAD))]
    for row in rows:
        names = [cell.ljust(width) for cell, width in zip(row[:3], widths[:3], strict=True)]
        numbers = [cell.rjust(width) for cell, width in zip(row[3:], widths[3:], strict=True)]
        yield "  ".join([*names, *numbers]).rstrip()
    for label, words in summary.labels.items():
        yield f"{label}: {', '.join(word or '(not noted)' for word in words)}"
    if len(summary.clocks) > 1:
        others = "; ".join(f"{clock}: {', '.join(names)}" for clock, names in summary.clocks.items() if clock != "log")
        yield f"with the times of another clock, whose offset is not known: {others}"


def _cells(channel: ChannelSummary) -> tuple[str, ...]:
    counts = (channel.missing, channel.no_target, channel.stale, channel.outliers)
    limits = (channel.low, channel.high)
    return (
        channel.name,
        channel.unit or "-",
        channel.role,
        str(channel.rows),
        *(str(count) if count else "-" for count in counts),
        *("-" if limit is None else f"{limit:.4g}" for limit in limits),
        f"{channel.step:.2g}" if channel.step else "-",
        channel.noise.text,
        channel.known,
    )


_COUNTED = (SampleQuality.MISSING, SampleQuality.NO_TARGET, SampleQuality.STALE)


def _outliers(measurement: Measurement, name: str) -> Iterator[Mask]:
    """Yield the outliers of each trial; on a bench of a range sensor, readings far from the known distance."""
    for trial in measurement.trials:
        channel = trial[name]
        if measurement.kind is CaseKind.TOF_BENCH and name == "reading_m":
            sd = channel.noise_sd if channel.noise_sd is not None else 1.0
            yield far_out((usable(channel) - trial["distance_m"].values) / sd)
        elif trial.is_timed or measurement.kind is CaseKind.MOTOR_STEADY:
            yield spikes(channel)


def _noise(measurement: Measurement, name: str) -> NoiseSummary:
    """Return the noise: the median over the trials of the standard deviation and of the correlation.

    On a bench it is the noise of repeats, in units of the stated noise if that differs from row to row.
    """
    repeats = _REPEATS.get(measurement.kind)
    if repeats is not None:
        return repeats(measurement, name)
    if not all(trial.is_timed for trial in measurement.trials):
        return NoiseSummary("-")
    noises = [noise for channel in measurement.across(name) for noise in (noise_of(channel),) if noise is not None]
    if not noises:
        return NoiseSummary("-")
    if 2 * sum(not noise.is_resolved for noise in noises) > len(noises):
        return NoiseSummary("below resolution")
    if 2 * sum(noise.is_separable for noise in noises) < len(measurement.trials):
        return NoiseSummary("not separable")
    sd, correlation = np.median([(noise.sd, noise.correlation) for noise in noises], axis=0).tolist()
    return NoiseSummary(f"{sd:.2g}, corr {correlation:+.2f}" if sd > 0.0 else "0", sd, correlation)


def _steady_repeats(measurement: Measurement, name: str) -> NoiseSummary:
    """Return the noise of readings at the same voltage in several sweeps of one motor."""
    noise = noise_of_equal_voltages(measurement, name)
    if not noise:
        return NoiseSummary("-")
    return NoiseSummary(f"{noise.sd:.2g} of {noise.rows} repeats", float(noise.sd), repeats=noise.rows)


def _range_repeats(measurement: Measurement, name: str) -> NoiseSummary:
    """Return the noise of readings of the same target at about the same temperature, in units of the stated noise."""
    z, conditions = [], []
    names = set(measurement.channel_names())
    for trial in measurement.trials:
        channel = trial[name]
        if channel.noise_sd is None:
            return NoiseSummary("-")
        z += (usable(channel) / channel.noise_sd).tolist()
        logged = [trial[quantity].values for quantity in ("distance_m", "incidence_rad") if quantity in names]
        logged += [np.floor(trial["temperature_C"].values / SAME_TEMPERATURE_K)] if "temperature_C" in names else []
        columns = [np.nan_to_num(values, nan=NOT_NOTED).round(6).tolist() for values in logged]
        conditions += zip(trial.label("material").values, *columns, strict=True)
    noise = noise_of_repeats(np.array(z), conditions)
    if not noise:
        return NoiseSummary("-")
    text = f"{noise.sd:.2f} x known, {noise.rows} repeats"
    return NoiseSummary(text, float(noise.sd), repeats=noise.rows, in_known=True)


_REPEATS: dict[CaseKind, Callable[[Measurement, str], NoiseSummary]] = {
    CaseKind.MOTOR_STEADY: _steady_repeats,
    CaseKind.TOF_BENCH: _range_repeats,
}


def _known(across: tuple[Channel, ...]) -> str:
    """Return the stated noise as text: one number, or the smallest and the largest one."""
    stated: list[Array] = [channel.noise_sd for channel in across if channel.noise_sd is not None]
    if not stated:
        return "-"
    low, high = min(float(np.nanmin(sd)) for sd in stated), max(float(np.nanmax(sd)) for sd in stated)
    text = f"{low:.2g}" if low == high else f"{low:.2g} to {high:.2g}"
    correlation = across[0].noise_correlation
    return f"{text}, corr {correlation:+.2f}" if correlation else text
