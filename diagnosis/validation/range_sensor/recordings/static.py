"""Noise and drift of a long recording of a sensor at rest, compared with the noise of the model."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.validation.experiment import ExperimentResult, Table
from diagnosis.validation.measures import mean_and_sd
from diagnosis.validation.panels import Curve, Panel
from diagnosis.validation.range_sensor.recordings.scan import MAX_RANGE_MM
from diagnosis.validation.range_sensor.stand import SensorOnStand, target
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.text_file import read_text
from symolo.core.tables.table import NumberColumn, number, table_of
from symolo.pages.plotting import BLACK, BLUE, VERMILION

MIN_READINGS = 1000
MODEL_READINGS = 30_000
MIN_GROUPS = 6
"""Fewest groups of the longest length that must fit into a recording; fewer give no useful average."""
DRIFT_FACTOR = 1.5
"""Ratio to the deviation of white noise above which a longer average helps little."""
MAX_NAME_LENGTH = 60
"""Longest name of a file in a title."""


@dataclass(frozen=True)
class RestRecording:
    """A recording of a sensor at rest."""

    rate_hz: float
    logging_s: float
    """Duration in the header of the file."""
    readings_mm: Array
    """(N,), readings of the sensor [mm]."""


def read_rest_recording(path: Path) -> RestRecording:
    """Read a file with the header lines `Fs,<Hz>`, `Logging time,<s>` and `d`, and one reading [mm] per row.

    Raises:
        InputError: The file has another form; the message names file, row and column.
    """
    text = read_text(path)
    lines = text.lines
    if len(lines) < 3 + MIN_READINGS:
        allowed = f"3 rows of header and at least {MIN_READINGS} readings"
        raise InputError(f"has {len(lines)} rows", where=str(path), allowed=allowed)
    rate_hz = _positive(lines[0], "Fs", path, 1)
    logging_s = _positive(lines[1], "Logging time", path, 2)
    if lines[2].strip() != "d":
        raise InputError("column 1", where=f"{path}: row 3", got=lines[2].strip(), allowed="the name d")
    readings = table_of(text, (NumberColumn("d", low=0.0, high=MAX_RANGE_MM),), (0,), first=3).checked()
    return RestRecording(rate_hz, logging_s, readings.numbers["d"])


def _positive(line: str, name: str, path: Path, row: int) -> float:
    label, comma, text = line.partition(",")
    if not comma or label.strip() != name:
        raise InputError("column 1", where=f"{path}: row {row}", got=label.strip(), allowed=f"{name},<number>")
    value = number(text, "2", f"{path}: row {row}")
    if value <= 0.0:
        raise InputError("column 2", where=f"{path}: row {row}", got=value, allowed="more than 0")
    return value


def at_rest(mounted: SensorOnStand, name: str, recording: RestRecording) -> ExperimentResult:
    """Return the noise of the recording, and that of the model in front of a white board at the mean distance."""
    readings, rate_hz = recording.readings_mm, recording.rate_hz
    lengths = group_lengths(len(readings))
    deviation = allan_deviation(readings, lengths)
    white = deviation[0] / np.sqrt(lengths)
    drifts = deviation > DRIFT_FACTOR * white
    # Index of the first length from which on all lengths show drift; len(lengths) if the last one shows none.
    first = len(drifts) - int(np.argmin(drifts[::-1])) if not drifts.all() else 0
    minute = max(1, round(60.0 * rate_hz))
    minutes = readings[: len(readings) // minute * minute].reshape(-1, minute).mean(axis=1)
    minutes = minutes if len(minutes) else readings.mean(keepdims=True)
    mean_mm, sd_mm = mean_and_sd(readings)
    model = mounted.facing(target(1e-3 * mean_mm), "static", name).readings_mm(MODEL_READINGS)
    model_mean_mm, model_sd_mm = mean_and_sd(model)
    model_lengths = group_lengths(len(model))
    lowest = int(deviation.argmin())
    measured = {
        "rate_hz": rate_hz,
        "header_logging_s": recording.logging_s,
        "spanned_s": len(readings) / rate_hz,
        "mean_mm": mean_mm,
        "sd_mm": sd_mm,
        # From one reading to the next: the Allan deviation of single readings.
        "white_sd_mm": float(deviation[0]),
        "next_reading_correlation": correlation(readings),
        "lowest_deviation_mm": float(deviation[lowest]),
        "lowest_at_s": lengths[lowest] / rate_hz,
        # From here on the deviation stays above `DRIFT_FACTOR` times that of white noise; NaN if never.
        "drifts_from_s": lengths[first] / rate_hz if first < len(lengths) else np.nan,
        "highest_minute_mm": float(minutes.max()),
        "lowest_minute_mm": float(minutes.min()),
        "averaged_s": np.array(lengths) / rate_hz,
        "deviation_mm": deviation,
    }
    modelled = {
        "mean_mm": model_mean_mm,
        "sd_mm": model_sd_mm,
        "averaged_s": np.array(model_lengths) / rate_hz,
        "deviation_mm": allan_deviation(model, model_lengths),
    }
    curves = (
        Curve(measured["averaged_s"], deviation, "measured", BLACK, "o-", size=4),
        Curve(modelled["averaged_s"], modelled["deviation_mm"], "model, white board", VERMILION, "x--"),
        Curve(measured["averaged_s"], white, "white noise of the measured size", BLUE, ":"),
    )
    shown_name = name if len(name) <= MAX_NAME_LENGTH else f"{name[: MAX_NAME_LENGTH - 3]}..."
    title = f"At rest at {mean_mm:.0f} mm\n{shown_name}"
    panel = Panel(title, "averaged over [s]", "Allan deviation [mm]", curves, is_logarithmic=True)
    tables = {"measured": measured, "model": modelled}
    return ExperimentResult(tables, panels=(panel,), notes=notes(measured, model_sd_mm))


def allan_deviation(readings: Array, lengths: tuple[int, ...]) -> Array:
    """Return the overlapping Allan deviation of evenly spaced readings (IEEE Std 952-1997, Annex C), (len(lengths),).

    It is the deviation of the means of neighbouring groups of n readings, over the root of two. For white noise of
    deviation s it is s / sqrt(n); a drift of r per reading gives r n / sqrt(2).
    """
    total = np.concatenate([[0.0], np.cumsum(readings - readings.mean())])
    deviations = []
    for n in lengths:
        mean = (total[n:] - total[:-n]) / n
        deviations.append(np.sqrt(0.5 * np.mean((mean[n:] - mean[:-n]) ** 2)))
    return np.array(deviations)


def group_lengths(count: int) -> tuple[int, ...]:
    """Return three group lengths per octave, from one reading to the longest that `count` readings allow."""
    longest = max(1, count // MIN_GROUPS)
    powers = 2.0 ** (np.arange(3 * np.log2(longest) + 1) / 3.0)
    return tuple(sorted({int(n) for n in powers if n <= longest}))


def correlation(readings: Array) -> float:
    """Return the correlation between one reading and the next."""
    off = readings - readings.mean()
    return float(np.mean(off[1:] * off[:-1]) / np.mean(off**2)) if off.any() else 0.0


def notes(measured: Table, model_sd_mm: float) -> list[str]:
    """Return sentences on the noise and drift of the recording, and on what the model leaves out."""
    ratio = ""
    if model_sd_mm > 0.0:
        ratio = f" ({measured['white_sd_mm'] / model_sd_mm:.2f} times the robot's noise_scale would match)"
    drift = "averaging follows the square-root law of white noise"
    not_modelled = ""
    if not np.isnan(measured["drifts_from_s"]):
        drift = f"averaging over {measured['drifts_from_s']:.2g} s and more gains less than it would with white noise"
        not_modelled = (
            ". NOT IN THIS ROBOT: without range_wander its noise is white (temperature_drift and warmup_drift follow a "
            "temperature or one exponential)"
        )
    lines = [
        (
            f"noise of a reading {measured['white_sd_mm']:.2f} mm, that of the model {model_sd_mm:.2f} mm{ratio}; the "
            f"correlation of successive readings is {measured['next_reading_correlation']:.2f}"
        ),
        (
            f"{drift}; the deviation is lowest, {measured['lowest_deviation_mm']:.2f} mm, at "
            f"{measured['lowest_at_s']:.2g} s. Means of a minute range from {measured['lowest_minute_mm']:.2f} to "
            f"{measured['highest_minute_mm']:.2f} mm{not_modelled}"
        ),
    ]
    logging_s, spanned_s = measured["header_logging_s"], measured["spanned_s"]
    if abs(logging_s / spanned_s - 1.0) > 0.01:
        lines.append(
            f"the header states {logging_s:.0f} s, but the rows at {measured['rate_hz']:g} Hz span {spanned_s:.0f} s; "
            "all times here follow from the rate and may be wrong by as much"
        )
    return lines
