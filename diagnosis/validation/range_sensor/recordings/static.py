"""A long recording of a sensor at rest, beside the model's noise: white noise, drift, Allan deviation."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.validation.experiment import ExperimentResult, Table
from diagnosis.validation.panels import Curve, Panel
from diagnosis.validation.range_sensor.recordings.allan import allan_deviation, group_lengths
from diagnosis.validation.range_sensor.recordings.scan import MAX_RANGE_MM
from diagnosis.validation.range_sensor.stand import SensorOnStand, closed_form, target
from diagnosis.validation.still_world import StillWorld
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.text_file import read_text
from symolo.core.table import NumberColumn, number, table_of
from symolo.pages.plotting import BLACK, BLUE, VERMILION

MIN_READINGS = 1000
MODEL_READINGS = 30_000
DRIFT_FACTOR = 1.5
"""Factor over the deviation that white noise would leave; above it averaging longer helps little."""


@dataclass(frozen=True)
class RestRecording:
    """A recording of a sensor at rest."""

    rate_hz: float
    logging_s: float
    """Duration as the header of the file says."""
    readings_mm: Array
    """(N,)."""


def read_rest_recording(path: Path) -> RestRecording:
    """Read rate and readings of a file.

    It has three lines of header, `Fs,<Hz>`, `Logging time,<s>` and `d`, then one reading [mm] per row.

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
    """Return the recording's noise, and that of the model before a white board at the recording's mean."""
    readings, rate_hz = recording.readings_mm, recording.rate_hz
    lengths = group_lengths(len(readings))
    deviation = allan_deviation(readings, lengths)
    drifts = deviation > DRIFT_FACTOR * deviation[0] / np.sqrt(lengths)
    first = len(drifts) - int(np.argmin(drifts[::-1])) if not drifts.all() else 0
    minute = max(1, round(60.0 * rate_hz))
    minutes = readings[: len(readings) // minute * minute].reshape(-1, minute).mean(axis=1)
    minutes = minutes if len(minutes) else readings.mean(keepdims=True)
    arena = target(1e-3 * float(readings.mean()))
    sensor = mounted.sensor(arena, "static", name)
    model = mounted.readings_mm(sensor, StillWorld(closed_form(arena)), MODEL_READINGS)
    model_lengths = group_lengths(len(model))
    lowest = int(deviation.argmin())
    measured = {
        "rate_hz": rate_hz,
        "header_logging_s": recording.logging_s,
        "spanned_s": len(readings) / rate_hz,
        "mean_mm": float(readings.mean()),
        "sd_mm": float(readings.std(ddof=1)),
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
        "mean_mm": float(model.mean()),
        "sd_mm": float(model.std(ddof=1)),
        "averaged_s": np.array(model_lengths) / rate_hz,
        "deviation_mm": allan_deviation(model, model_lengths),
    }
    white = deviation[0] / np.sqrt(lengths)
    curves = (
        Curve(measured["averaged_s"], deviation, "measured", BLACK, "o-", size=4),
        Curve(modelled["averaged_s"], modelled["deviation_mm"], "model, white board", VERMILION, "x--"),
        Curve(measured["averaged_s"], white, "white noise of the measured size", BLUE, ":"),
    )
    title = f"At rest at {measured['mean_mm']:.0f} mm\n{_short(name)}"
    panel = Panel(title, "averaged over [s]", "Allan deviation [mm]", curves, is_logarithmic=True)
    tables = {"measured": measured, "model": modelled}
    return ExperimentResult(tables, panels=(panel,), notes=notes(measured, modelled["sd_mm"]))


def correlation(readings: Array) -> float:
    """Return the correlation between one reading and the next."""
    off = readings - readings.mean()
    return float(np.mean(off[1:] * off[:-1]) / np.mean(off**2)) if off.any() else 0.0


def notes(measured: Table, model_sd_mm: float) -> list[str]:
    """Return what the recording shows and the model lacks, in sentences."""
    drifts = not np.isnan(measured["drifts_from_s"])
    late = f"from {measured['drifts_from_s']:.2g} s on" if drifts else "never"
    ratio = ""
    if model_sd_mm > 0.0:
        ratio = f" ({measured['white_sd_mm'] / model_sd_mm:.2f} times the robot's noise_scale would match)"
    wanders = (
        ". NOT IN THE MODEL: its noise is white, nothing in it wanders (temperature_drift and warmup_drift follow a "
        "temperature or one exponential)"
    )
    lines = [
        (
            f"noise of a reading {measured['white_sd_mm']:.2f} mm, the model's {model_sd_mm:.2f} mm"
            f"{ratio}; next readings correlate "
            f"by {measured['next_reading_correlation']:.2f}"
        ),
        (
            f"averaging falls short of the square-root law of white noise {late}; the deviation is lowest, "
            f"{measured['lowest_deviation_mm']:.2f} mm, at {measured['lowest_at_s']:.2g} s. Means of a minute go from "
            f"{measured['lowest_minute_mm']:.2f} to {measured['highest_minute_mm']:.2f} mm{wanders if drifts else ''}"
        ),
    ]
    logging_s, spanned_s = measured["header_logging_s"], measured["spanned_s"]
    if abs(logging_s / spanned_s - 1.0) > 0.01:
        lines.append(
            f"the header says {logging_s:.0f} s, the rows at {measured['rate_hz']:g} Hz span {spanned_s:.0f} s; all "
            "times here go by the rate and may be as much off"
        )
    return lines


def _short(name: str) -> str:
    return name if len(name) <= 60 else f"{name[:57]}..."
