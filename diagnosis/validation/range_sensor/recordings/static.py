"""A long record of a sensor that stands still, and the model's noise beside it: white noise, drift, Allan deviation."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.measured.text_file import number, read_text
from diagnosis.validation.range_sensor.recordings.allan import allan_deviation, lengths_for
from diagnosis.validation.range_sensor.recordings.columns import range_mm
from diagnosis.validation.range_sensor.stand import Bench, Stand, closed_form, target
from symolo.core.arrays import Array
from symolo.core.errors import InputError

FEWEST = 1000
MODEL_READINGS = 30_000
DRIFTS_ABOVE = 1.5
"""Times what white noise would leave: from there on averaging longer helps little."""


@dataclass(frozen=True)
class Record:
    rate_hz: float
    logging_s: float
    """As the header says."""
    readings_mm: Array
    """(N,)."""


@dataclass(frozen=True)
class AllanCurve:
    averaged_s: tuple[float, ...]
    deviation_mm: tuple[float, ...]


@dataclass(frozen=True)
class StaticComparison:
    """One record beside as good a board at the same mean distance as the model has."""

    file: str
    rate_hz: float
    header_logging_s: float
    """As the file says."""
    spanned_s: float
    """By its rows and its rate."""
    mean_mm: float
    sd_mm: float
    white_sd_mm: float
    """From one reading to the next: the Allan deviation of single readings."""
    next_reading_correlation: float
    lowest_deviation_mm: float
    lowest_at_s: float
    drifts_from_s: float | None
    """Averaging time from which the deviation stays above `DRIFTS_ABOVE` times that of white noise."""
    highest_minute_mm: float
    lowest_minute_mm: float
    """Means over whole minutes."""
    measured: AllanCurve
    model_mean_mm: float
    model_sd_mm: float
    model: AllanCurve


def read_record(path: Path) -> Record:
    """Rate and readings of a file.

    It has three lines of header, `Fs,<Hz>`, `Logging time,<s>` and `d`, then one reading [mm] per row.

    Raises:
        InputError: It is not so; the text names file, row and column.
    """
    lines = read_text(path).lines
    if len(lines) < 3 + FEWEST:
        allowed = f"3 rows of header and at least {FEWEST} readings"
        raise InputError(f"has {len(lines)} rows", where=str(path), allowed=allowed)
    rate_hz = _positive(lines[0], "Fs", path, 1)
    logging_s = _positive(lines[1], "Logging time", path, 2)
    if lines[2].strip() != "d":
        raise InputError("column 1", where=f"{path}: row 3", got=lines[2].strip(), allowed="the name d")
    readings = np.array([range_mm(text, path, row, "d") for row, text in enumerate(lines[3:], start=4)])
    return Record(rate_hz, logging_s, readings)


def _positive(line: str, name: str, path: Path, row: int) -> float:
    found, comma, text = line.partition(",")
    if not comma or found.strip() != name:
        raise InputError("column 1", where=f"{path}: row {row}", got=found.strip(), allowed=f"{name},<number>")
    value = number(text, path, row, "2")
    if value <= 0.0:
        raise InputError("column 2", where=f"{path}: row {row}", got=value, allowed="more than 0")
    return value


def compare_static(bench: Bench, name: str, record: Record) -> StaticComparison:
    """The record's noise, and that of the model before a white board at the record's mean."""
    readings = record.readings_mm
    lengths = lengths_for(len(readings))
    deviation = allan_deviation(readings, lengths)
    white = deviation[0] / np.sqrt(lengths)
    above = deviation > DRIFTS_ABOVE * white
    first = len(above) - int(np.argmin(above[::-1])) if not above.all() else 0
    minute = max(1, round(60.0 * record.rate_hz))
    minutes = readings[: len(readings) // minute * minute].reshape(-1, minute).mean(axis=1)
    minutes = minutes if len(minutes) else readings.mean(keepdims=True)
    model = _model(bench, float(readings.mean()), name)
    lowest = int(deviation.argmin())
    return StaticComparison(
        file=name,
        rate_hz=record.rate_hz,
        header_logging_s=record.logging_s,
        spanned_s=len(readings) / record.rate_hz,
        mean_mm=float(readings.mean()),
        sd_mm=float(readings.std(ddof=1)),
        white_sd_mm=float(deviation[0]),
        next_reading_correlation=correlation(readings),
        lowest_deviation_mm=float(deviation[lowest]),
        lowest_at_s=lengths[lowest] / record.rate_hz,
        drifts_from_s=lengths[first] / record.rate_hz if first < len(lengths) else None,
        highest_minute_mm=float(minutes.max()),
        lowest_minute_mm=float(minutes.min()),
        measured=_curve(readings, record.rate_hz),
        model_mean_mm=float(model.mean()),
        model_sd_mm=float(model.std(ddof=1)),
        model=_curve(model, record.rate_hz),
    )


def _model(bench: Bench, distance_mm: float, name: str) -> Array:
    arena = target(1e-3 * distance_mm)
    return bench.readings_mm(bench.sensor(arena, "static", name), Stand(closed_form(arena)), MODEL_READINGS)


def _curve(readings: Array, rate_hz: float) -> AllanCurve:
    lengths = lengths_for(len(readings))
    averaged = tuple(n / rate_hz for n in lengths)
    return AllanCurve(averaged, tuple(allan_deviation(readings, lengths).tolist()))


def correlation(readings: Array) -> float:
    """Between one reading and the next."""
    off = readings - readings.mean()
    return float(np.mean(off[1:] * off[:-1]) / np.mean(off**2)) if off.any() else 0.0


def findings(found: StaticComparison) -> list[str]:
    """What the record shows and the model has not, in words."""
    late = "never" if found.drifts_from_s is None else f"from {found.drifts_from_s:.2g} s on"
    ratio = found.white_sd_mm / found.model_sd_mm if found.model_sd_mm > 0.0 else None
    scale = "" if ratio is None else f" ({ratio:.2f} times the robot's noise_scale would match)"
    wanders = (
        ". NOT IN THE MODEL: its noise is white, nothing in it wanders (temperature_drift and warmup_drift follow a "
        "temperature or one exponential)"
    )
    lacking = "" if found.drifts_from_s is None else wanders
    noise = (
        f"{found.file}: noise of a reading {found.white_sd_mm:.2f} mm, the model's {found.model_sd_mm:.2f} mm{scale}; "
        f"next readings correlate by {found.next_reading_correlation:.2f}"
    )
    drift = (
        f"{found.file}: averaging falls short of the root law of white noise {late}; the deviation is lowest, "
        f"{found.lowest_deviation_mm:.2f} mm, at {found.lowest_at_s:.2g} s. Means of a minute go from "
        f"{found.lowest_minute_mm:.2f} to {found.highest_minute_mm:.2f} mm{lacking}"
    )
    if abs(found.header_logging_s / found.spanned_s - 1.0) <= 0.01:
        return [noise, drift]
    header = (
        f"{found.file}: its header says {found.header_logging_s:.0f} s, its rows at {found.rate_hz:g} Hz span "
        f"{found.spanned_s:.0f} s; all times here go by the rate and may be as much off"
    )
    return [noise, drift, header]
