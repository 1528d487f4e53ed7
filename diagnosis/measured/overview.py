"""The text of `symolo inspect`: trials with rates and gaps, and channels with missing samples, outliers and noise."""

from collections.abc import Callable, Iterator

import numpy as np

from diagnosis.measured.channel import Channel, Mask, Role, SampleQuality
from diagnosis.measured.measurement import CaseKind, Measurement, Trial
from diagnosis.measured.noise import noise_of_repeats
from diagnosis.measured.screening import far_out, noise_of, resolution, spikes, timing, usable
from symolo.core.arrays import Array

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


def overview(measurement: Measurement) -> list[str]:
    """Return the lines of the text."""
    licence = f" ({measurement.source.licence})" if measurement.source.licence else ""
    lines = [summary_line(measurement), f"source: {measurement.source.origin}{licence}"]
    if measurement.source.files:
        first, *more = measurement.source.files
        lines.append(f"read from {first}{f' and {len(more)} more' if more else ''}")
    if measurement.nominal is None:
        lines.append("nominal parameters: none came with the data")
    lines += ["", *_trials(measurement), "", *_channels(measurement)]
    lines += ["", *(f"note: {note}" for note in measurement.notes)] if measurement.notes else []
    return lines


def summary_line(measurement: Measurement) -> str:
    """Return one line with name, kind, trials and rows."""
    rows, held = measurement.rows, measurement.heldout_rows
    split = f"{rows - held} to fit, {held} held out" if held else "none held out"
    trials = len(measurement.trials)
    return f"{measurement.name}: {measurement.kind}, {trials} trial{'s' * (trials > 1)}, {rows} rows ({split})"


def _trials(measurement: Measurement) -> Iterator[str]:
    times = f"{'begins, s':>12}{'lasts, s':>11}{'rate, Hz':>10}{'gaps':>6}{'longest, s':>12}"
    yield f"{'trial':28}{'rows':>7}{'held out':>10}{times}"
    for trial in measurement.trials[:MAX_TRIALS]:
        held = int(np.count_nonzero(trial.holdout))
        begins = "-" if trial.begins_s is None else f"{trial.begins_s + trial.t_s[0]:.3f}"
        yield f"{trial.name:28}{len(trial.t_s):>7}{held:>10}{begins:>12}{_times(trial)}"
    more = len(measurement.trials) - MAX_TRIALS
    if more > 0:
        yield f"and {more} more"


def _times(trial: Trial) -> str:
    steps = timing(trial.t_s) if trial.is_timed else None
    if steps is None:
        return f"{'-':>11}{'-':>10}{'-':>6}{'-':>12}"
    lasts_s = trial.t_s[-1] - trial.t_s[0]
    return f"{lasts_s:>11.2f}{steps.rate_hz:>10.3g}{steps.gaps:>6}{steps.longest_s:>12.3g}"


def _channels(measurement: Measurement) -> Iterator[str]:
    rows = [_HEAD, *(_cells(measurement, name) for name in measurement.channel_names())]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_HEAD))]
    for row in rows:
        names = [cell.ljust(width) for cell, width in zip(row[:3], widths[:3], strict=True)]
        numbers = [cell.rjust(width) for cell, width in zip(row[3:], widths[3:], strict=True)]
        yield "  ".join([*names, *numbers]).rstrip()
    for label in measurement.trials[0].labels:
        words = sorted({word for trial in measurement.trials for word in trial.label(label.name).values})
        yield f"{label.name}: {', '.join(word or '(not noted)' for word in words)}"
    clocks: dict[str, list[str]] = {}
    for channel in measurement.trials[0].channels:
        clocks.setdefault(channel.clock, []).append(channel.name)
    if len(clocks) > 1:
        others = "; ".join(f"{clock}: {', '.join(names)}" for clock, names in clocks.items() if clock != "log")
        yield f"with the times of another clock, whose offset is not known: {others}"


def _cells(measurement: Measurement, name: str) -> tuple[str, ...]:
    across = measurement.across(name)
    first = across[0]
    values = np.concatenate([usable(channel) for channel in across])
    known = values[np.isfinite(values)]
    counts = [sum(channel.count(quality) for channel in across) for quality in _COUNTED]
    is_reading = first.role is Role.READING
    outliers = sum(int(np.count_nonzero(mask)) for mask in _outliers(measurement, name)) if is_reading else 0
    return (
        name,
        first.unit or "-",
        first.role,
        str(len(values)),
        *(str(count) if count else "-" for count in counts),
        str(outliers) if outliers else "-",
        f"{known.min():.4g}" if len(known) else "-",
        f"{known.max():.4g}" if len(known) else "-",
        f"{step:.2g}" if (step := resolution(values)) else "-",
        _noise(measurement, name) if is_reading else "-",
        _known(across),
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


def _noise(measurement: Measurement, name: str) -> str:
    """Return the noise as text: the median over the trials of the standard deviation and of the correlation.

    On a bench it is the noise of repeats, in units of the stated noise if that differs from row to row.
    """
    repeats = _REPEATS.get(measurement.kind)
    if repeats is not None:
        return repeats(measurement, name)
    if not all(trial.is_timed for trial in measurement.trials):
        return "-"
    noises = [noise for channel in measurement.across(name) for noise in (noise_of(channel),) if noise is not None]
    if not noises:
        return "-"
    if 2 * sum(not noise.is_resolved for noise in noises) > len(noises):
        return "below resolution"
    if 2 * sum(noise.is_separable for noise in noises) < len(measurement.trials):
        return "not separable"
    sd, correlation = np.median([(noise.sd, noise.correlation) for noise in noises], axis=0).tolist()
    return f"{sd:.2g}, corr {correlation:+.2f}" if sd > 0.0 else "0"


def _steady_repeats(measurement: Measurement, name: str) -> str:
    """Return the noise of readings at the same voltage in several sweeps of one motor."""
    trials = measurement.trials
    values = np.concatenate([usable(trial[name]) for trial in trials])
    conditions = [(trial.part, voltage) for trial in trials for voltage in trial["u_cmd_V"].values.round(6).tolist()]
    noise = noise_of_repeats(values, conditions)
    return f"{noise.sd:.2g} of {noise.rows} repeats" if noise else "-"


def _range_repeats(measurement: Measurement, name: str) -> str:
    """Return the noise of readings of the same target at about the same temperature, in units of the stated noise."""
    z, conditions = [], []
    names = set(measurement.channel_names())
    for trial in measurement.trials:
        channel = trial[name]
        if channel.noise_sd is None:
            return "-"
        z += (usable(channel) / channel.noise_sd).tolist()
        logged = [trial[quantity].values for quantity in ("distance_m", "incidence_rad") if quantity in names]
        logged += [np.floor(trial["temperature_C"].values / SAME_TEMPERATURE_K)] if "temperature_C" in names else []
        columns = [np.nan_to_num(values, nan=NOT_NOTED).round(6).tolist() for values in logged]
        conditions += zip(trial.label("material").values, *columns, strict=True)
    noise = noise_of_repeats(np.array(z), conditions)
    return f"{noise.sd:.2f} x known, {noise.rows} repeats" if noise else "-"


_REPEATS: dict[CaseKind, Callable[[Measurement, str], str]] = {
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
