"""Importers of measured data: one file each, and one line in the table here."""

from diagnosis.importers import (
    drive_log,
    micromouse,
    motor_steady,
    motor_step,
    optiodom,
    paper,
    robotino,
    symolo_csv,
    tof_bench,
    vl53l0x_scan,
    vl53l0x_static,
)
from diagnosis.importers.base import Importer

IMPORTERS: tuple[Importer, ...] = (
    motor_steady.IMPORTER,
    motor_step.IMPORTER,
    tof_bench.IMPORTER,
    drive_log.IMPORTER,
    symolo_csv.IMPORTER,
    optiodom.IMPORTER,
    micromouse.IMPORTER,
    robotino.IMPORTER,
    vl53l0x_static.IMPORTER,
    vl53l0x_scan.IMPORTER,
    paper.IMPORTER,
)
"""Importers in the order in which they are tried; no two recognise the same data."""
