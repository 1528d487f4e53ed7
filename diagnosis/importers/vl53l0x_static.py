"""Long log of a VL53L0X at rest, at an unknown distance: for its noise and drift."""

from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.validation.range_sensor.recordings.static import read_rest_recording
from logs.recognition import first_line, only_log
from symolo.core.tables.time_series import TimeSeries


def _is_log(path: Path) -> bool:
    return first_line(path).startswith("Fs,")


def _read(path: Path) -> Measurement:
    path = only_log(path, _is_log) or path
    recording = read_rest_recording(path)
    t_s = np.arange(len(recording.readings_mm)) / recording.rate_hz
    reading = Channel.logged(TimeSeries("reading_m", "m", t_s, 1e-3 * recording.readings_mm), Role.READING)
    trial = Trial("1", t_s, np.zeros(len(t_s), dtype=bool), (reading,))
    source = MeasurementSource("VL53L0X at rest, tomisuarez2/TimeOfFlightCalibration", (str(path),), "MIT")
    notes = [f"times by the rate in the header, {recording.rate_hz:g} Hz", "not logged: distance"]
    spanned_s = len(t_s) / recording.rate_hz
    if abs(spanned_s - recording.logging_s) > 0.01 * recording.logging_s:
        notes.append(
            f"the header states {recording.logging_s:g} s of logging, but the rows at this rate span {spanned_s:.0f} s"
        )
    return Measurement(path.stem, CaseKind.OTHER, source, (trial,), notes=tuple(notes))


IMPORTER = Importer("vl53l0x-static", lambda path: only_log(path, _is_log) is not None, _read)
