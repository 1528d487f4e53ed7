"""Importers of measured data; one file per member, one line here for each."""

from diagnosis.importers import (
    drive_log,
    micromouse,
    motor_steady,
    motor_step,
    optiodom,
    paper,
    robotino,
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
    optiodom.IMPORTER,
    micromouse.IMPORTER,
    robotino.IMPORTER,
    vl53l0x_static.IMPORTER,
    vl53l0x_scan.IMPORTER,
    paper.IMPORTER,
)
"""In the order in which they are asked; no two recognise the same thing."""
