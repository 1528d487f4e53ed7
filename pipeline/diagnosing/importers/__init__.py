"""All importers of measured data: those of `diagnosis`, and those of SyMoLo datasets."""

from diagnosis.importers import IMPORTERS as MEASURED
from diagnosis.importers.base import Importer
from pipeline.diagnosing.importers import data_csv, run_folder

IMPORTERS: tuple[Importer, ...] = (*MEASURED, run_folder.IMPORTER, data_csv.IMPORTER)
"""Importers in the order in which they are tried; a single data.csv comes after a run folder."""
