"""Tables 1, 3 and 4 of the paper, which are measured data too and are chosen by name, not by a folder."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np

from configs.schema.arena import SurfaceName
from diagnosis.importers.base import Importer
from diagnosis.measured.channel import Channel, Label, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.motor_identification import TABLE_1
from diagnosis.validation.range_sensor.paper import TABLE_3, TABLE_4, PrintedReadings
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.tables.time_series import TimeSeries

BOARD_M = 0.1
"""Distance of the boards of Tables 3 and 4."""


def _motor() -> Measurement:
    row = np.arange(len(TABLE_1.voltage_V), dtype=np.float64)
    channels = (
        Channel.logged(TimeSeries("u_cmd_V", "V", row, TABLE_1.voltage_V), Role.INPUT),
        Channel.logged(TimeSeries("current_A", "A", row, TABLE_1.current_A), Role.READING),
        Channel.logged(TimeSeries("omega_rad_s", "rad/s", row, TABLE_1.speed_rad_s), Role.READING),
    )
    notes = ("not noted: times, noise; nothing is marked as held out",)
    return Measurement("table-1", CaseKind.MOTOR_STEADY, _source("Table 1"), (_trial(row, channels),), notes=notes)


def _surfaces(number: int, table: Mapping[SurfaceName, PrintedReadings]) -> Measurement:
    row = np.arange(len(table), dtype=np.float64)
    mean_m = 1e-3 * np.array([printed.mean_mm for printed in table.values()])
    sd_m = 1e-3 * np.array([printed.sd_mm for printed in table.values()])
    distance = TimeSeries("distance_m", "m", row, np.full(len(row), BOARD_M))
    channels = (
        Channel.logged(distance, Role.INPUT),
        Channel.logged(TimeSeries("reading_m", "m", row, mean_m), Role.READING, noise_sd=sd_m),
    )
    notes = (
        "each reading is a mean of many, and the paper does not state of how many; the noise is that of one reading",
        "not noted: times, temperature, light; nothing is marked as held out",
    )
    trial = _trial(row, channels, Label("material", tuple(table)))
    return Measurement(f"table-{number}", CaseKind.TOF_BENCH, _source(f"Table {number}"), (trial,), notes=notes)


def _trial(row: Array, channels: tuple[Channel, ...], *labels: Label) -> Trial:
    return Trial("1", row, np.zeros(len(row), dtype=bool), channels, labels, is_timed=False)


def _source(table: str) -> MeasurementSource:
    return MeasurementSource(f"the paper's {table}", ())


TABLES: Mapping[str, Callable[[], Measurement]] = {
    "table-1": _motor,
    "table-3": partial(_surfaces, 3, TABLE_3),
    "table-4": partial(_surfaces, 4, TABLE_4),
}


def _read(path: Path) -> Measurement:
    if path.as_posix() not in TABLES:
        raise InputError("is no table of the paper", where=str(path), allowed=", ".join(TABLES))
    return TABLES[path.as_posix()]()


IMPORTER = Importer("paper", lambda path: path.as_posix() in TABLES and not path.exists(), _read)
